// SPDX-License-Identifier: Apache-2.0
// Tasks that stand in for each other. A primary and its standbys are a group, of which one is ON at a time. When that
// one goes to ERROR, or its process dies, another one takes over, in this order: the primary, its standbys in the order
// of the description. The choice follows from the states of tasks over all contexts, so every context makes the same
// one. runtime/cycle/recovery.h turns tasks ON. docs/design/standby.md.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/task/state_machine.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; O(members of groups); no allocation.
class Standbys {
 public:
  /// At most this many takeovers of one group within kWindow. A failure beyond them is not answered.
  static constexpr std::size_t kMostTakeovers = 3;
  static constexpr Nanoseconds kWindow = seconds(10);

  /// The spec and the rivals outlive this. Context: setup.
  void prepare(const ApplicationSpec& spec, const Rivals& rivals, SetupMemory& memory);
  std::size_t n_groups() const noexcept { return mechanisms::kStandbys ? groups_.size() : 0; }

  /// `states[t]` is that of task t, over all contexts, at `now`; `living` are the contexts whose processes live.
  void follow(std::span<const State> states, std::uint32_t living, Nanoseconds now) noexcept;
  /// A switch leads to `target`: a group of which no task is in it is given up.
  void follow_switch(const TaskBits& target) noexcept;
  /// The task has failed, and a standby that is OFF, or NOT-CREATED for its resource, may be ON within one period of
  /// its own: until then the task counts as ON where the illegal-configuration flag is judged.
  bool is_covered(TaskId task) const noexcept { return mechanisms::kStandbys && is_covered_[task.index]; }
  /// Some group lost the task that was ON, that task is still in ERROR, and no task took over in time.
  bool is_any_uncovered() const noexcept { return mechanisms::kStandbys && is_any_uncovered_; }
  /// Some group waits for a task to take over.
  bool is_any_waiting() const noexcept { return is_any_waiting_; }
  /// When follow() gives another result although no state has changed; kNever: never.
  Nanoseconds due() const noexcept { return due_; }

  /// Some task is a hot standby.
  bool has_hot() const noexcept { return has_hot_; }
  /// True for a hot standby if another task of its group is ON, or was when it failed, and no signal has turned the
  /// standby OFF since that one went ON.
  bool keeps_warm(TaskId task) const noexcept;
  /// A signal turned a hot standby OFF. It stays OFF until another task of its group goes ON, or until a call with
  /// false.
  void let_cool(TaskId task, bool is_cool) noexcept { is_cool_[task.index] = is_cool; }

  /// The group that the task belongs to; n_groups(): none.
  std::size_t group_of(TaskId task) const noexcept;
  std::span<const TaskId> members(std::size_t group) const noexcept { return groups_[group].members; }
  /// The task that is to go ON in place of the one that failed in group `group`; invalid: none is, or none can.
  TaskId next(std::size_t group) const noexcept;
  /// One task that failed, and was ON before.
  struct Loss {
    TaskId task;
    Nanoseconds at, covered_until;  ///< it was found then, and counts as ON until then
  };
  /// The last one of that group. Requires: next(group) was valid once.
  const Loss& loss(std::size_t group) const noexcept { return groups_[group].loss; }
  /// The task could not go ON. It is passed over until its group has a task that is ON again.
  void rule_out(TaskId task) noexcept { is_out_[task.index] = true; }
  /// The task stands in a group that waits for another one to take over from it.
  bool is_awaited(TaskId task) const noexcept;
  /// Adds the covered tasks, except those whose group has a task in `beside`.
  void add_covered(std::span<bool> on, std::span<const TaskId> beside) const noexcept;
  /// A task of its group other than itself is ON.
  bool is_replaced(TaskId task) const noexcept;

 private:
  struct Group {
    std::span<const TaskId> members;  // the primary first
    TaskId on;                        // the member that was ON last; invalid: none, or it was turned OFF
    bool is_lost = false;             // it failed, and none is ON since
    bool is_waiting = false;          // and a task may take over
    Loss loss;
    Nanoseconds taken_over[kMostTakeovers] = {Nanoseconds{INT64_MIN}, Nanoseconds{INT64_MIN}, Nanoseconds{INT64_MIN}};
  };

  void follow(Group& group, Nanoseconds now) noexcept;
  void lose(Group& group, Nanoseconds now) noexcept;
  void gain(Group& group, TaskId on, Nanoseconds now) noexcept;
  void sum_up(Nanoseconds now) noexcept;
  TaskId next(const Group& group) const noexcept;
  static bool has(const Group& group, TaskId task) noexcept;
  State state(TaskId task) const noexcept { return states_[task.index]; }

  std::span<const TaskSpec> tasks_;
  const Rivals* rivals_ = nullptr;
  std::span<Group> groups_;
  std::span<TaskId> members_;
  std::span<State> states_;      // by task, at the last follow()
  std::span<bool> is_covered_;   // by task
  std::span<bool> is_out_;       // by task
  std::span<bool> is_hot_, is_cool_;  // by task
  std::uint32_t living_ = 0;
  Nanoseconds due_ = kNever;
  bool is_any_uncovered_ = false;
  bool is_any_waiting_ = false;
  bool has_hot_ = false;
};

}  // namespace chimera
