// SPDX-License-Identifier: Apache-2.0
// Whether a signal to tasks of one context may be carried out, beyond what the states of these tasks say: which tasks
// would be ON over all contexts, who has the resource, and whether another context is about to do the same.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/refusal.h"
#include "chimera/runtime/switch/rivals.h"
#include "chimera/task/signal.h"

namespace chimera {

class TaskSet;

/// Context of everything not marked: edge; wait-free.
class SignalJudge {
 public:
  explicit SignalJudge(TaskSet& set) noexcept : set_(set) {}
  /// Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);

  /// Why `signal` to these tasks is refused; kNone: it is not. O(tasks + links). From now on, until this context has
  /// shown what it changed, no other context turns tasks of their groups of standbys ON.
  Refusal judge(std::span<const TaskId> tasks, Signal signal) noexcept;
  /// No task would lack a producer and no variable would have two, if `tasks` were ON besides those that are, over all
  /// contexts. A task that waits for its standby counts as ON, but beside that standby.
  bool would_be_legal(std::span<const TaskId> tasks) noexcept;
  /// The set that the last judgement of `on` was about: wanted()[t] says whether task t is in it.
  std::span<const bool> wanted() const noexcept { return wanted_; }
  /// A task that is created, in whatever context, and has a resource of `task`; invalid: none.
  TaskId find_rival(TaskId task) const noexcept;
  /// Which tasks cannot be created at one time.
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
