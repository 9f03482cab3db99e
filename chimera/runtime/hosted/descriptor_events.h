// SPDX-License-Identifier: Apache-2.0
// Events that components read from descriptors (event_source), on Linux, in a loop without preemption.
#pragma once

#include "chimera/runtime/life/event_inputs.h"

namespace chimera {

/// A descriptor that is readable while its task is ON is one event. It gives the next one after `sync` has answered.
class DescriptorEvents final : public EventInputs {
 public:
  /// Context: cycle; one system call for a task that waits for an event.
  std::uint32_t take(const Task& task, bool waits) noexcept override;
};

}  // namespace chimera
