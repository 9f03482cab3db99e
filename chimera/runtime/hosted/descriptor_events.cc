// SPDX-License-Identifier: Apache-2.0
// Asks the system whether the descriptor of a task is readable.
#include "chimera/runtime/hosted/descriptor_events.h"

#include "chimera/platform/descriptor.h"

namespace chimera {

std::uint32_t DescriptorEvents::take(const Task& task, bool waits) noexcept {
  if (waits || task.descriptor < 0 || task.state != State::kOn) return 0;
  return await_readable({&task.descriptor, 1}, {}) ? 1 : 0;
}

}  // namespace chimera
