// SPDX-License-Identifier: Apache-2.0
// Hides values that are too old from one task.
#include "chimera/runtime/life/stale_inputs.h"

#include <algorithm>

#include "chimera/base/mechanisms.h"
#include "chimera/runtime/life/task_host.h"

namespace chimera {

namespace {

/// Limit of age of a variable that comes over a link; kNever: it comes over none.
Nanoseconds limit_of_link(const ApplicationSpec& spec, RtpuId here, const Variable& variable) noexcept {
  Nanoseconds limit = kNever;
  for (const PortOf& producer : variable.producers) {
    const TaskSpec& task = spec.tasks[producer.task.index];
    if (task.rtpu == here || task.rtpu.index >= spec.rtpus.size()) continue;
    const LinkSpec& link = spec.rtpus[task.rtpu.index].link;
    if (link.is_there()) limit = std::min(limit, link.stale_after + task.period);
  }
  return limit;
}

}  // namespace

StaleInputs* StaleInputs::make(Nanoseconds after, TaskId reader, TaskMemory& task, const ApplicationSpec& spec,
                               SetupMemory& memory) {
  const auto limit = [&](std::size_t i) {
    const Variable& variable = spec.variables[task.input_spec(i).variable.index];
    if (variable.is_given()) return kNever;
    return mechanisms::kPeers ? std::min(after, limit_of_link(spec, spec.tasks[reader.index].rtpu, variable)) : after;
  };
  const std::size_t n = task.inputs().size();
  bool is_any = after != kNever;
  for (std::size_t i = 0; i < n; ++i) is_any = is_any || limit(i) != kNever;
  if (!is_any) return nullptr;
  StaleInputs& made = memory.take<StaleInputs>(1)[0];
  made.limits_ = memory.take<Nanoseconds>(n);
  made.slots_ = memory.take<chimera_slot>(n);
  for (std::size_t i = 0; i < n; ++i) made.limits_[i] = limit(i);
  return &made;
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
    if (me.limits_[i] == kNever || call->now_ns - port.slot->published_ns <= me.limits_[i].count) continue;
    me.slots_[i] = *port.slot;
    me.slots_[i].valid = 0;
    port.slot = &me.slots_[i];
  }
  return task.component->methods[CHIMERA_CYCLE](instance, call);
}

}  // namespace chimera
