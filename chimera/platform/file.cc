// SPDX-License-Identifier: Apache-2.0
// Reads files by pread, replaces files by rename, and appends lines under a lock.
#include "chimera/platform/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace chimera {
namespace {

constexpr int kMostTries = 10;  // to open a file that other processes rename again and again

Error refusal(const char* what, int error, const std::string& path, ErrorCode code = ErrorCode::kSystem) {
  return (Message() << what << ": " << std::strerror(error)).error(code, path);
}

/// A new or changed name then survives a power cut.
void sync_folder_of(const std::string& path) noexcept {
  const std::string folder = path.substr(0, path.find_last_of('/') + 1);
  const OwnedDescriptor opened(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.fd >= 0) (void)::fsync(opened.fd);
}

/// True if `path` still names the open file.
bool is_at(const std::string& path, const struct stat& opened) noexcept {
  struct stat there {};
  return ::stat(path.c_str(), &there) == 0 && there.st_dev == opened.st_dev && there.st_ino == opened.st_ino;
}

/// The whole lines within the last `most` of `bytes` bytes. The byte before them shows whether a line begins there.
std::string whole_lines(int file, std::uint64_t bytes, std::size_t most) {
  const std::uint64_t from = bytes > most ? bytes - most - 1 : 0;
  std::string text(static_cast<std::size_t>(bytes - from), '\0');
  const std::int64_t got = read_at(file, from, std::as_writable_bytes(std::span(text)));
  text.resize(static_cast<std::size_t>(std::max<std::int64_t>(got, 0)));
  text.erase(text.find_last_of('\n') + 1);
  if (bytes > most) text.erase(0, std::min(text.find('\n') + 1, text.size()));
  return text;
}

/// Number of bytes up to the end of the last whole line.
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

/// False with errno; EEXIST: there is a file at `path`, and it may not be replaced. NFS has no such flag, but links.
bool rename_part(const std::string& part, const std::string& path, bool may_replace) noexcept {
  if (may_replace) return ::rename(part.c_str(), path.c_str()) == 0;
  if (::renameat2(AT_FDCWD, part.c_str(), AT_FDCWD, path.c_str(), RENAME_NOREPLACE) == 0) return true;
  return errno == EINVAL && ::link(part.c_str(), path.c_str()) == 0 && ::unlink(part.c_str()) == 0;
}

}  // namespace

FileStart::FileStart(const char* path) noexcept {
  const OwnedDescriptor file(::open(path, O_RDONLY | O_CLOEXEC));
  ssize_t got = 0;
  while (file.fd >= 0 && size + 1 < sizeof bytes && (got = ::read(file.fd, bytes + size, sizeof bytes - 1 - size)) > 0)
    size += static_cast<std::size_t>(got);
}

std::int64_t file_size(int file) noexcept {
  struct stat status {};
  return ::fstat(file, &status) == 0 ? status.st_size : -1;
}

std::int64_t read_at(int file, std::uint64_t offset, std::span<std::byte> to) noexcept {
  std::size_t done = 0;
  while (done < to.size()) {
    const ssize_t got = ::pread(file, to.data() + done, to.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return static_cast<std::int64_t>(done);
}

bool free_bytes_before(int file, std::uint64_t offset) noexcept {
  return ::fallocate(file, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(offset)) == 0;
}

std::optional<FileState> state_of_file(const std::string& path) {
  struct stat state {};
  if (::stat(path.c_str(), &state) != 0) return std::nullopt;
  return FileState{state.st_ino, state.st_mode & 07777u, state.st_ctim.tv_sec * 1'000'000'000 + state.st_ctim.tv_nsec};
}

Result<void> replace_file(const std::string& path, const FileState& known, std::string_view text) {
  std::string made = path + ".XXXXXX";
  OwnedDescriptor file(::mkstemp(made.data()));
  if (file.fd < 0) return refusal("cannot be written", errno, path, ErrorCode::kRefused);
  bool is_good = ::write(file.fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                 ::fchmod(file.fd, known.mode) == 0 && ::fsync(file.fd) == 0;
  file = OwnedDescriptor();
  const bool is_same = state_of_file(path) == known;
  is_good = is_good && is_same && ::rename(made.c_str(), path.c_str()) == 0;
  if (is_good) return {};
  const int error = errno;
  ::unlink(made.c_str());
  return is_same ? refusal("cannot be written", error, path, ErrorCode::kRefused)
                 : Message("changed just now").error(ErrorCode::kRefused, path);
}

Result<OwnedDescriptor> open_to_append(const std::string& path) {
  OwnedDescriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0666));
  struct stat status {};
  if (file.fd < 0 || ::fstat(file.fd, &status) != 0) return refusal("cannot be opened", errno, path);
  if (!S_ISREG(status.st_mode)) return Message("is no ordinary file").error(ErrorCode::kRefused, path);
  if (whole_bytes(file.fd, static_cast<std::uint64_t>(status.st_size)) == static_cast<std::uint64_t>(status.st_size))
    return file;
  if (::write(file.fd, "\n", 1) != 1) return refusal("cannot be written", errno, path);
  return file;
}

bool make_private_folder(const std::string& path) {
  struct stat state {};
  return ::mkdir(path.c_str(), 0700) == 0 || (::stat(path.c_str(), &state) == 0 && S_ISDIR(state.st_mode));
}

Result<PartFile> PartFile::open(const std::string& path, unsigned mode) {
  struct stat there {};
  if (::stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode))
    return Message("is no ordinary file").error(ErrorCode::kRefused, path);
  std::string part = path + "." + std::to_string(::getpid()) + ".part";
  OwnedDescriptor file(::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
  if (file.fd < 0) return refusal("cannot be written", errno, path);
  return PartFile(path, std::move(part), std::move(file));
}

PartFile::~PartFile() {
  if (file_.fd >= 0) ::unlink(part_.c_str());
}

Result<void> PartFile::put(std::string_view text, bool may_replace) {
  errno = ENOSPC;  // a short write sets no errno itself
  if (::write(file_.fd, text.data(), text.size()) != static_cast<ssize_t>(text.size()) || ::fsync(file_.fd) != 0)
    return refusal("cannot be written", errno, path_);
  if (!rename_part(part_, path_, may_replace))
    return errno == EEXIST ? Message("is there already").error(ErrorCode::kRefused, path_)
                           : refusal("cannot be written", errno, path_);
  file_ = OwnedDescriptor();
  return {};
}

Result<LineFile> LineFile::open(const std::string& path) {
  for (int i = 0; i < kMostTries; ++i) {
    OwnedDescriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0600));
    if (file.fd < 0) return refusal("cannot be opened", errno, path);
    struct stat status {};
    if (::fstat(file.fd, &status) != 0) return refusal("cannot be opened", errno, path);
    if (!S_ISREG(status.st_mode)) return Message("is no ordinary file").error(ErrorCode::kRefused, path);
    if (::flock(file.fd, LOCK_EX) != 0) return refusal("cannot be locked", errno, path);
    if (!is_at(path, status)) continue;  // renamed while this process waited for the lock
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
    if (put > 0)
      done += static_cast<std::size_t>(put);
    else if (put == 0 || errno != EINTR)
      error = put == 0 ? ENOSPC : errno;
  }
  if (error == 0 && ::fsync(file_.fd) != 0) error = errno;
  if (error == 0) {
    bytes_ += lines.size();
    return {};
  }
  // If this fails, the next open() cuts off the part of a line; whole lines before it stay.
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
