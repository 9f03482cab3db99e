// SPDX-License-Identifier: Apache-2.0
// The age of the inputs of one task, judged before each of its cycles: an input older than `stale_after` is not valid
// for it. Replaces the component's cycle, so that jobs of other tasks pay nothing for it.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/state/task_memory.h"
#include "chimera/task/task.h"

namespace chimera {

class StaleInputs {
 public:
  /// Makes the judge for the task with that memory; null: none of its inputs can be too old. `after`: its own limit,
  /// kNever: none. Values of the operator hold until the next one: they are never too old. A value that a task of
  /// another rtpu, a board, published is too old after `stale_after` of the link and a period of that task. Context:
  /// setup.
  static StaleInputs* make(Nanoseconds after, TaskId reader, TaskMemory& task, const ApplicationSpec& spec,
                           SetupMemory& memory);
  /// From now on the task's cycles are judged, if it has a StaleInputs (TaskHost::stale) and a cycle. Context: cycle
  /// boundary.
  static void judge_cycles_of(Task& task) noexcept;

 private:
  static std::int32_t cycle(void* instance, const chimera_call* call);

  std::span<Nanoseconds> limits_;  // by input; kNever: not judged
  std::span<chimera_slot> slots_;  // by input: in place of the one that is too old, with nothing valid
};

}  // namespace chimera
