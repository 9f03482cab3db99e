// SPDX-License-Identifier: Apache-2.0
// Looks for an input without a value.
#include "chimera/runtime/missing_value.h"

#include <algorithm>

#include "chimera/runtime/job_step.h"

namespace chimera {

VariableId missing_value(TaskSet& set, Task& task, std::span<const Handover> handovers) noexcept {
  read_inputs(task);
  const TaskMemory& memory = set.memory(task.id);
  for (std::size_t i = 0; i < task.inputs.size(); ++i) {
    const VariableId variable = memory.input_spec(i).variable;
    const auto is_its = [&](const Handover& handover) { return handover.variable == variable; };
    if (std::any_of(handovers.begin(), handovers.end(), is_its)) continue;
    const chimera_port& port = *task.inputs[i].port;
    if (((port.slot->valid >> port.bit) & 1u) == 0) return variable;
  }
  return {};
}

}  // namespace chimera
