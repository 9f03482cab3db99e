// SPDX-License-Identifier: Apache-2.0
// A file descriptor with an owner, and the text of a system call that failed.
#pragma once

#include <utility>

#include "chimera/base/message.h"

namespace chimera {

/// Closes unless released. Move-only. Context: setup.
struct OwnedDescriptor {
  explicit OwnedDescriptor(int f = -1) noexcept : fd(f) {}
  OwnedDescriptor(OwnedDescriptor&& other) noexcept : fd(std::exchange(other.fd, -1)) {}
  OwnedDescriptor& operator=(OwnedDescriptor&& other) noexcept {
    std::swap(fd, other.fd);
    return *this;
  }
  ~OwnedDescriptor();
  int release() noexcept { return std::exchange(fd, -1); }
  int fd;  ///< -1: none
};

/// "WHAT: CALL failed: REASON" by errno. Context: setup.
Error system_error(const Message& what, const char* call) noexcept;

}  // namespace chimera
