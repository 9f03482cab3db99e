// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "chimera/base/message.h"

namespace chimera {

/// Closes unless released. Move-only.
struct OwnedDescriptor {
  explicit OwnedDescriptor(int f = -1) noexcept : fd(f) {}
  OwnedDescriptor(OwnedDescriptor&& other) noexcept : fd(std::exchange(other.fd, -1)) {}
  OwnedDescriptor& operator=(OwnedDescriptor&& other) noexcept {
    std::swap(fd, other.fd);
    return *this;
  }
  ~OwnedDescriptor() {
    if (fd >= 0) ::close(fd);
  }
  int release() noexcept { return std::exchange(fd, -1); }
  int fd;
};

/// "WHAT: CALL failed: REASON" by errno.
inline Error system_error(const Message& what, const char* call) noexcept {
  const int error = errno;
  return (Message() << what.view() << ": " << call << " failed: " << ::strerrordesc_np(error))
      .error(ErrorCode::kSystem);
}

}  // namespace chimera
