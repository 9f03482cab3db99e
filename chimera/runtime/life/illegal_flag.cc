// SPDX-License-Identifier: Apache-2.0
// Judges the illegal-configuration flag of one context.
#include "chimera/runtime/life/illegal_flag.h"

#include "chimera/runtime/set_equations.h"

namespace chimera {

void IllegalFlag::prepare(std::span<const Variable> variables, std::span<const Task> tasks, SetupMemory& memory) {
  variables_ = variables;
  tasks_ = tasks;
  raises_in_ = memory.take<State>(tasks.size());
}

void IllegalFlag::raise(bool up) noexcept {
  is_raised_ = up;
  if (!up) lower(true);
  judge();
}

void IllegalFlag::hold(bool up) noexcept {
  is_held_ = up;
  judge();
}

void IllegalFlag::raise_for(TaskId task, State in) noexcept {
  raised_by_ = task;
  raises_in_[task.index] = in;
  judge();
}

void IllegalFlag::follow(std::span<const bool> on, bool is_uncovered, std::uint32_t configuration) noexcept {
  if (!is_held_) configuration_.store(configuration, std::memory_order_relaxed);
  is_on_set_legal_ = !is_uncovered && is_legal_set(variables_, on);
  if (raised_by_.is_valid()) lower(false);
  judge();
}

// Lowers the flag for tasks that are no longer in the state in which their reaction raised it, or for all tasks.
void IllegalFlag::lower(bool for_all) noexcept {
  raised_by_ = TaskId();
  for (const Task& task : tasks_) {
    State& in = raises_in_[task.id.index];
    if (for_all || task.state != in) in = State::kNotCreated;
    if (in != State::kNotCreated) raised_by_ = task.id;
  }
}

}  // namespace chimera
