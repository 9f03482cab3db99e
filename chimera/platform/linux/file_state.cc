// SPDX-License-Identifier: Apache-2.0
// Looks at inodes and times of change, and replaces a file by renaming a new one.
#include "chimera/platform/file_state.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "chimera/platform/owned_descriptor.h"

namespace chimera {

std::optional<FileState> state_of_file(const std::string& path) {
  struct stat state {};
  if (::stat(path.c_str(), &state) != 0) return std::nullopt;
  return FileState{state.st_ino, state.st_mode & 07777u,
                   state.st_ctim.tv_sec * 1'000'000'000 + state.st_ctim.tv_nsec};
}

Result<void> replace_file(const std::string& path, const FileState& known, std::string_view text) {
  std::string made = path + ".XXXXXX";
  OwnedDescriptor file(::mkstemp(made.data()));
  if (file.fd < 0)
    return (Message() << "cannot be written: " << std::strerror(errno)).error(ErrorCode::kRefused, path);
  bool is_good = ::write(file.fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                 ::fchmod(file.fd, known.mode) == 0 && ::fsync(file.fd) == 0;
  file = OwnedDescriptor();
  const bool is_same = state_of_file(path) == known;
  is_good = is_good && is_same && ::rename(made.c_str(), path.c_str()) == 0;
  if (is_good) return {};
  const int error = errno;
  const Message why = is_same ? Message() << "cannot be written: " << std::strerror(error)
                              : Message("changed just now");
  ::unlink(made.c_str());
  return why.error(ErrorCode::kRefused, path);
}

bool make_private_folder(const std::string& path) {
  struct stat state {};
  return ::mkdir(path.c_str(), 0700) == 0 || (::stat(path.c_str(), &state) == 0 && S_ISDIR(state.st_mode));
}

std::int64_t wall_clock_shift() noexcept {
  timespec wall{}, monotonic{};
  ::clock_gettime(CLOCK_REALTIME, &wall);
  ::clock_gettime(CLOCK_MONOTONIC, &monotonic);
  return (wall.tv_sec - monotonic.tv_sec) * 1'000'000'000 + wall.tv_nsec - monotonic.tv_nsec;
}

}  // namespace chimera
