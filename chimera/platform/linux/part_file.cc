// SPDX-License-Identifier: Apache-2.0
// Writes a file under a name of its own, syncs it, and renames it.
#include "chimera/platform/part_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace chimera {
namespace {

Error not_written(const std::string& path, int error) {
  return (Message() << "cannot be written: " << std::strerror(error)).error(ErrorCode::kSystem, path);
}

}  // namespace

Result<PartFile> PartFile::open(const std::string& path) {
  struct stat there {};
  if (::stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode))
    return Message("is no ordinary file").error(ErrorCode::kRefused, path);
  std::string part = path + "." + std::to_string(::getpid()) + ".part";
  OwnedDescriptor file(::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.fd < 0) return not_written(path, errno);
  return PartFile(path, std::move(part), std::move(file));
}

PartFile::~PartFile() {
  if (file_.fd >= 0) ::unlink(part_.c_str());
}

Result<void> PartFile::put(std::string_view text) {
  errno = ENOSPC;  // a write that is cut short says nothing itself
  const bool is_good = ::write(file_.fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       ::fsync(file_.fd) == 0 && ::rename(part_.c_str(), path_.c_str()) == 0;
  if (!is_good) return not_written(path_, errno);
  file_ = OwnedDescriptor();
  return {};
}

}  // namespace chimera
