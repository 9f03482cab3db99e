// SPDX-License-Identifier: Apache-2.0
// Judges the illegal-configuration flag of one context.
#include "chimera/runtime/illegal_flag.h"

#include "chimera/runtime/set_equations.h"

namespace chimera {

void IllegalFlag::prepare(std::span<const Variable> variables, std::span<const Task> tasks, SetupMemory& memory) {
  variables_ = variables;
  tasks_ = tasks;
  raises_ = memory.take<bool>(tasks.size());
}

void IllegalFlag::raise(bool up) noexcept {
  is_raised_ = up;
  if (!up) lower(true);
  judge();
}

void IllegalFlag::raise_for(TaskId task) noexcept {
  raised_by_ = task;
  raises_[task.index] = true;
  judge();
}

void IllegalFlag::follow(std::span<const bool> on) noexcept {
  is_on_set_legal_ = is_legal_set(variables_, on);
  if (raised_by_.is_valid()) lower(false);
  judge();
}

// What tasks raised that are no longer ON, or all did.
void IllegalFlag::lower(bool for_all) noexcept {
  raised_by_ = TaskId();
  for (const Task& task : tasks_) {
    raises_[task.id.index] = raises_[task.id.index] && task.state == State::kOn && !for_all;
    if (raises_[task.id.index]) raised_by_ = task.id;
  }
}

}  // namespace chimera
