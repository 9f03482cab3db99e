// SPDX-License-Identifier: Apache-2.0
// Appends lines under a lock, takes back what was written in part, and syncs file and folder.
#include "chimera/platform/line_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "chimera/platform/file_bytes.h"

namespace chimera {
namespace {

constexpr int kMostTries = 10;  // at a file that others replace just then

Error refusal(const char* what, int error, const std::string& path) {
  return (Message() << what << ": " << std::strerror(error)).error(ErrorCode::kSystem, path);
}

/// A name that was made or changed survives a power cut.
void sync_folder_of(const std::string& path) noexcept {
  const std::string folder = path.substr(0, path.find_last_of('/') + 1);
  const OwnedDescriptor opened(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.fd >= 0) (void)::fsync(opened.fd);
}

/// Whether `path` still leads to the open file.
bool is_at(const std::string& path, const struct stat& opened) noexcept {
  struct stat there {};
  return ::stat(path.c_str(), &there) == 0 && there.st_dev == opened.st_dev && there.st_ino == opened.st_ino;
}

/// The lines that lie within the last `most` of `bytes` bytes. One byte more tells whether the first begins there.
std::string whole_lines(int file, std::uint64_t bytes, std::size_t most) {
  const std::uint64_t from = bytes > most ? bytes - most - 1 : 0;
  std::string text(static_cast<std::size_t>(bytes - from), '\0');
  const std::int64_t got = read_at(file, from, std::as_writable_bytes(std::span(text)));
  text.resize(static_cast<std::size_t>(std::max<std::int64_t>(got, 0)));
  text.erase(text.find_last_of('\n') + 1);
  if (bytes > most) text.erase(0, std::min(text.find('\n') + 1, text.size()));
  return text;
}

/// Bytes up to the end of the last whole line.
std::uint64_t whole_bytes(int file, std::uint64_t bytes) {
  constexpr std::size_t kAtOnce = 1 << 16;
  std::string text;
  for (std::uint64_t end = bytes; end > 0;) {
    const std::uint64_t from = end - std::min<std::uint64_t>(end, kAtOnce);
    text.assign(static_cast<std::size_t>(end - from), '\0');
    if (read_at(file, from, std::as_writable_bytes(std::span(text))) != static_cast<std::int64_t>(text.size()))
      return bytes;
    if (const std::size_t at = text.rfind('\n'); at != std::string::npos) return from + at + 1;
    end = from;
  }
  return 0;
}

}  // namespace

Result<LineFile> LineFile::open(const std::string& path) {
  for (int i = 0; i < kMostTries; ++i) {
    OwnedDescriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0600));
    if (file.fd < 0) return refusal("cannot be opened", errno, path);
    struct stat status {};
    if (::fstat(file.fd, &status) != 0) return refusal("cannot be opened", errno, path);
    if (!S_ISREG(status.st_mode)) return Message("is no ordinary file").error(ErrorCode::kRefused, path);
    if (::flock(file.fd, LOCK_EX) != 0) return refusal("cannot be locked", errno, path);
    if (!is_at(path, status)) continue;  // renamed while we waited
    const auto bytes = static_cast<std::uint64_t>(std::max<std::int64_t>(file_size(file.fd), 0));
    const std::uint64_t whole = whole_bytes(file.fd, bytes);
    if (whole < bytes && ::ftruncate(file.fd, static_cast<off_t>(whole)) != 0)
      return refusal("cannot be shortened", errno, path);
    if (bytes == 0) sync_folder_of(path);
    return LineFile(path, std::move(file), whole);
  }
  return Message("is renamed all the time").error(ErrorCode::kRefused, path);
}

std::string LineFile::tail(std::size_t most) const { return whole_lines(file_.fd, bytes_, most); }

Result<void> LineFile::append(std::string_view lines) {
  int error = 0;
  for (std::size_t done = 0; done < lines.size() && error == 0;) {
    const ssize_t put = ::write(file_.fd, lines.data() + done, lines.size() - done);
    if (put > 0) done += static_cast<std::size_t>(put);
    else if (put == 0 || errno != EINTR) error = put == 0 ? ENOSPC : errno;
  }
  if (error == 0 && ::fsync(file_.fd) != 0) error = errno;
  if (error == 0) {
    bytes_ += lines.size();
    return {};
  }
  // Not shortened: the next one that opens it cuts off the last part; whole lines before it stand.
  [[maybe_unused]] const int shortened = ::ftruncate(file_.fd, static_cast<off_t>(bytes_));
  return refusal("cannot be written", error, path_);
}

Result<void> LineFile::rename_to(const std::string& path) {
  if (::rename(path_.c_str(), path.c_str()) != 0) return refusal("cannot be renamed", errno, path_);
  path_ = path;
  sync_folder_of(path);
  return {};
}

}  // namespace chimera
