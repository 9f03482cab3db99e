// SPDX-License-Identifier: Apache-2.0
// Reads ordinary files only, and no more bytes than the caller allows. A pipe could block the reader for ever, and a
// device may have no end.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "chimera/base/message.h"
#include "chimera/base/result.h"

namespace chimera {

/// "a pipe", "a folder": the kind of file that `mode` describes, if the file is not an ordinary one. Context: any.
inline const char* file_kind(mode_t mode) noexcept {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

/// Opens `path` to read; does not block, and does not make a terminal the controlling one. Refuses, with the path in
/// `where`: a file that open() cannot open (kNotFound if it does not exist), a file that is not ordinary, a file of
/// more than `most` bytes. The caller closes the descriptor. Context: setup; may block on the disk only.
inline Result<int> open_ordinary(const std::string& path, std::size_t most) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  struct stat status {};
  // open() itself refuses a socket or a missing device with a text that misleads the user. stat() names the kind of
  // file.
  const bool is_seen = file >= 0 ? ::fstat(file, &status) == 0 : errno == ENXIO && ::stat(path.c_str(), &status) == 0;
  if (file < 0 && !is_seen)
    return (Message() << "cannot be opened: " << std::strerror(errno))
        .error(errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kSystem, path);
  if (is_seen && S_ISREG(status.st_mode) && static_cast<std::size_t>(status.st_size) <= most) return file;
  if (file >= 0) ::close(file);
  if (!S_ISREG(status.st_mode))
    return (Message() << "is no ordinary file but " << file_kind(status.st_mode)).error(ErrorCode::kRefused, path);
  return (Message() << "has " << static_cast<std::uint64_t>(status.st_size) << " bytes; at most "
                    << static_cast<std::uint64_t>(most) << " are read")
      .error(ErrorCode::kRefused, path);
}

/// The first `most` bytes of an ordinary file, or the whole file if it is shorter. Refuses the same files as
/// open_ordinary(), but accepts any size. Context: setup; may block on the disk only.
inline Result<std::string> read_ordinary(const std::string& path, std::size_t most) {
  const auto file = open_ordinary(path, static_cast<std::size_t>(-1));
  if (!file) return file.error();
  std::string text;
  ssize_t got = 1;
  while (got > 0 && text.size() < most) {
    const std::size_t had = text.size();
    text.resize(std::min(most, had + 65536));
    do got = ::read(*file, text.data() + had, text.size() - had);
    while (got < 0 && errno == EINTR);
    text.resize(had + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  }
  const int why = errno;
  ::close(*file);
  if (got >= 0) return text;
  return (Message() << "cannot be read: " << std::strerror(why)).error(ErrorCode::kSystem, path);
}

/// The reason why `path` cannot be read: "is no ordinary file but a pipe". "" for an ordinary file of at most `most`
/// bytes. "" also for a file that cannot be opened, because its reader reports that error. Context: setup; may block on
/// the disk only.
inline std::string not_ordinary(const std::string& path, std::size_t most) {
  const auto file = open_ordinary(path, most);
  if (file) ::close(*file);
  return file || file.error().code != ErrorCode::kRefused ? std::string() : std::string(file.error().message.view());
}

}  // namespace chimera
