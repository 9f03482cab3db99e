// SPDX-License-Identifier: Apache-2.0
// Judges whether a signal to tasks of one context may be carried out, beyond the states of these tasks: which tasks
// would be ON over all contexts, which task has the resource, and whether another context is about to do the same.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/runtime/refusal.h"
#include "chimera/task/signal.h"

namespace chimera {

class TaskSet;

/// Context of everything not marked: cycle boundary; wait-free.
class SignalJudge {
 public:
  explicit SignalJudge(TaskSet& set) noexcept : set_(set) {}
  /// Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);

  /// Reason to refuse `signal` to these tasks; kNone: it is not refused. O(tasks + links). From now on, until this
  /// context has shown its changes, no other context turns tasks of their groups of standbys ON.
  Refusal judge(std::span<const TaskId> tasks, Signal signal) noexcept;
  /// True if no task would lack a producer and no variable would have two, if `tasks` were ON besides those that are,
  /// over all contexts. A task that waits for its standby counts as ON, but not beside that standby.
  bool would_be_legal(std::span<const TaskId> tasks) noexcept;
  /// The set that the last judgement of `on` was about: wanted()[t] says whether task t is in it.
  std::span<const bool> wanted() const noexcept { return wanted_; }
  /// A task that is created, in any context, and has a resource of `task`; invalid: none.
  TaskId find_rival(TaskId task) const noexcept;
  /// The tasks that cannot be created at the same time.
  const Rivals& rivals() const noexcept { return rivals_; }
  /// The contexts whose processes live, this one among them: bits.
  std::uint32_t living() const noexcept;

 private:
  bool claims_groups_of(std::span<const TaskId> tasks) noexcept;
  bool claims_resource_of(TaskId task) noexcept;

  TaskSet& set_;
  Rivals rivals_;
  std::span<bool> wanted_;  // by task
};

}  // namespace chimera
