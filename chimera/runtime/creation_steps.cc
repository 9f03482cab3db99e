// SPDX-License-Identifier: Apache-2.0
// Remembers which tasks a slow switch has created and taken away.
#include "chimera/runtime/creation_steps.h"

#include <algorithm>

namespace chimera {

void CreationSteps::prepare(std::size_t n_tasks, SetupMemory& memory) {
  spawned_ = memory.take<bool>(n_tasks);
  killed_ = memory.take<bool>(n_tasks);
}

void CreationSteps::begin() noexcept {
  asked_ = TaskId();
  std::fill(spawned_.begin(), spawned_.end(), false);
  std::fill(killed_.begin(), killed_.end(), false);
}

StepEnd CreationSteps::cut(const Task& task, Signal signal) noexcept {
  if (asked_ != task.id) return StepEnd::kFailed;
  if (task.in_service) return StepEnd::kWaits;
  asked_ = TaskId();
  mark(task.id, signal, true);
  return StepEnd::kDone;
}

}  // namespace chimera
