// SPDX-License-Identifier: Apache-2.0
// The first bytes of a small file of /proc or /sys.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstddef>
#include <string_view>

namespace chimera {

/// At most 8191 bytes, zero-terminated; empty when the file cannot be read. Context: setup; may block.
struct FileStart {
  explicit FileStart(const char* path) noexcept {
    const int fd = ::open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return;
    ssize_t got = 0;
    while (size + 1 < sizeof bytes && (got = ::read(fd, bytes + size, sizeof bytes - 1 - size)) > 0)
      size += static_cast<std::size_t>(got);
    bytes[size] = '\0';
    ::close(fd);
  }
  std::string_view view() const noexcept { return {bytes, size}; }

  char bytes[8192] = {};
  std::size_t size = 0;
};

}  // namespace chimera
