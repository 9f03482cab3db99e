// SPDX-License-Identifier: Apache-2.0
// Ends a process that has lost its descriptors.
#include "chimera/platform/lost_descriptor.h"

#include <unistd.h>

#include <cstring>

namespace chimera {

void end_without_descriptor() noexcept {
  constexpr const char* kReason = "a component closed descriptors that are not its own: the process ends\n";
  if (::write(STDERR_FILENO, kReason, std::strlen(kReason)) < 0) ::_exit(kDescriptorLost);  // it may be closed as well
  ::_exit(kDescriptorLost);
}

}  // namespace chimera
