// SPDX-License-Identifier: Apache-2.0
// Opens the file of a recording. An earlier recording is never changed.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace chimera::library {

/// "log/arm.csv" and 2 become "log/arm.2.csv". Context: setup.
inline std::string numbered_path(const std::string& path, int number) {
  const std::size_t name = path.rfind('/') + 1;  // 0 without a folder
  const std::size_t dot = path.rfind('.');
  const std::size_t end = dot == std::string::npos || dot <= name ? path.size() : dot;
  return path.substr(0, end) + "." + std::to_string(number) + path.substr(end);
}

/// An open recording. The holder closes `file`.
struct RecordingFile {
  int file = -1;
  std::string path;  ///< of the file that was opened
};

/// Opens `path` to write. If it holds data or another process records to it, opens the first free one of NAME.2.csv,
/// NAME.3.csv and so on. Holds a lock on an ordinary file until its last descriptor is closed. Throws
/// std::runtime_error with the path. Context: setup; may block.
inline RecordingFile open_recording(const std::string& path) {
  constexpr int kMostFiles = 9999;
  for (int number = 1; number <= kMostFiles; ++number) {
    RecordingFile made{-1, number == 1 ? path : numbered_path(path, number)};
    made.file = ::open(made.path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
    if (made.file < 0) throw std::runtime_error(made.path + ": " + std::strerror(errno));
    struct stat about {};
    if (::fstat(made.file, &about) == 0 && !S_ISREG(about.st_mode)) return made;
    // Another error means that the file system has no locks. The size counts only under the lock.
    const bool is_ours = ::flock(made.file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
    if (is_ours && ::fstat(made.file, &about) == 0 && about.st_size == 0) return made;
    ::close(made.file);
  }
  throw std::runtime_error(path + ": " + std::to_string(kMostFiles) + " recordings of this name exist: move them");
}

/// Note for the user if the recording has another path than `wanted`; else empty. Context: setup.
inline std::string other_path_note(const std::string& wanted, const std::string& path) {
  if (path == wanted) return {};
  const std::size_t most = 100;  // the end of a long path identifies the file better than its start
  const std::string tail = path.size() > most ? "..." + path.substr(path.size() - most) : path;
  return "records to " + tail + ": an earlier recording has the name";
}

}  // namespace chimera::library
