// SPDX-License-Identifier: Apache-2.0
// Closes descriptors, and puts errno into words.
#include "chimera/platform/owned_descriptor.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace chimera {

OwnedDescriptor::~OwnedDescriptor() {
  if (fd >= 0) ::close(fd);
}

Error system_error(const Message& what, const char* call) noexcept {
  const int error = errno;
  return (Message() << what.view() << ": " << call << " failed: " << ::strerrordesc_np(error))
      .error(ErrorCode::kSystem);
}

}  // namespace chimera
