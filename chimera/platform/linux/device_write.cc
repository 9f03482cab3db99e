// SPDX-License-Identifier: Apache-2.0
// Writes without waiting to terminals, sockets and files.
#include "chimera/platform/device_write.h"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>

namespace chimera {

void take_over_device(int descriptor) noexcept {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags >= 0 && (flags & O_NONBLOCK) == 0) (void)::fcntl(descriptor, F_SETFL, flags | O_NONBLOCK);
  (void)::tcflush(descriptor, TCOFLUSH);  // refused where it is no terminal: there is nothing to drop
}

int write_device(int descriptor, std::span<const std::byte> bytes) noexcept {
  const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
  if (put >= 0) return static_cast<int>(put);
  return errno == EAGAIN || errno == EINTR ? 0 : -1;
}

}  // namespace chimera
