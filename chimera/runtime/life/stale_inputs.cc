// SPDX-License-Identifier: Apache-2.0
// Hides values that are too old from one task.
#include "chimera/runtime/life/stale_inputs.h"

#include "chimera/runtime/life/task_host.h"

namespace chimera {

StaleInputs& StaleInputs::make(Nanoseconds after, TaskMemory& task, std::span<const Variable> variables,
                               SetupMemory& memory) {
  const std::size_t n = task.inputs().size();
  StaleInputs& made = memory.take<StaleInputs>(1)[0];
  made.after_ = after;
  made.is_judged_ = memory.take<bool>(n);
  made.slots_ = memory.take<chimera_slot>(n);
  for (std::size_t i = 0; i < n; ++i)
    made.is_judged_[i] = !variables[task.input_spec(i).variable.index].is_given();
  return made;
}

void StaleInputs::judge_cycles_of(Task& task) noexcept {
  const auto* host = static_cast<const TaskHost*>(task.call.context);
  if (host != nullptr && host->stale != nullptr && task.cycle != nullptr) task.cycle = &StaleInputs::cycle;
}

std::int32_t StaleInputs::cycle(void* instance, const chimera_call* call) {
  const TaskHost& host = *static_cast<const TaskHost*>(call->context);
  StaleInputs& me = *host.stale;
  Task& task = *host.task;
  for (std::size_t i = 0; i < task.inputs.size(); ++i) {
    chimera_port& port = *task.inputs[i].port;
    if (!me.is_judged_[i] || call->now_ns - port.slot->published_ns <= me.after_.count) continue;
    me.slots_[i] = *port.slot;
    me.slots_[i].valid = 0;
    port.slot = &me.slots_[i];
  }
  return task.component->methods[CHIMERA_CYCLE](instance, call);
}

}  // namespace chimera
