// SPDX-License-Identifier: Apache-2.0
// Asks for the size of open files and reads them by pread.
#include "chimera/platform/file_bytes.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace chimera {

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

}  // namespace chimera
