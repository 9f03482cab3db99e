// SPDX-License-Identifier: Apache-2.0
// A simulated face: asks for one thing after the other and waits for each answer; what a dead manager owed it, it asks
// the next one.
#pragma once

#include <vector>

#include "tests/subsystem/world.h"

namespace chimera::simulated {

class Face {
 public:
  Face(ManagerState& world, std::size_t index) : world_(world), index_(index) {}

  /// Asks by chance again and again until the world is calm.
  void live();
  void ask(Signal signal, std::vector<TaskId> tasks);

  bool is_waiting() const noexcept { return is_waiting_; }
  bool is_waiting_at_door(std::uint32_t manager) const noexcept { return is_waiting_ && asked_of_ != manager; }
  bool wants_down(TaskId task) const noexcept;
  void let_in(std::uint32_t manager);
  void answered(const subsystem::CommandAnswer& answer);
  Nanoseconds asked_at() const noexcept { return asked_at_; }
  Signal signal() const noexcept { return signal_; }
  const std::vector<TaskId>& tasks() const noexcept { return tasks_; }
  const subsystem::CommandAnswer& last() const noexcept { return last_; }

 private:
  void ask_by_chance();
  bool swap();
  std::vector<TaskId> in_state(State state, bool starters_only) const;

  ManagerState& world_;
  std::size_t index_;
  bool is_waiting_ = false;
  std::uint32_t asked_of_ = 0;
  Nanoseconds asked_at_;
  Signal signal_ = Signal::kOn;
  std::vector<TaskId> tasks_;
  subsystem::CommandAnswer last_;
};

}  // namespace chimera::simulated
