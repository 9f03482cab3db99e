// SPDX-License-Identifier: Apache-2.0
// State that the parts of a Subsystem share: the application, the known state of its processes, pending signals, and
// the list of actions.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/subsystem/observed_state.h"
#include "chimera/subsystem/subsystem.h"

namespace chimera::subsystem {

/// A signal that was sent and has no report yet.
struct PendingSignal {
  std::uint64_t command = 0;
  Signal signal = Signal::kOn;
  Nanoseconds sent;
  Nanoseconds due;  ///< kNever: no longer awaited, though it may still be carried out
};

/// An rtpu accepts the posts of one sender in order. A report on one post proves that all before it were accepted, so
/// the given-up ones are over too. Context: setup.
class PendingSignals {
 public:
  explicit PendingSignals(std::size_t n_tasks) : tasks_(n_tasks) {}

  /// Command numbers never repeat, not even over managers: each manager begins at the instant of its start.
  void begin(Nanoseconds now) noexcept { last_ = now.count > 0 ? static_cast<std::uint64_t>(now.count) : 0; }
  /// Returns the number of the command.
  std::uint64_t post(Signal signal, std::span<const TaskId> tasks, Nanoseconds now);
  /// Removes the entry of `command`. False if the command is no longer awaited.
  bool settle(TaskId task, std::uint64_t command);
  void drop(TaskId task) { tasks_[task.index].clear(); }

  std::vector<PendingSignal>& of(TaskId task) noexcept { return tasks_[task.index]; }
  /// True if an answer is awaited.
  bool is_awaited(TaskId task) const noexcept;
  bool is_awaited(TaskId task, Signal signal) const noexcept;
  /// True if such a signal was sent and is not known to be over, even if it was given up.
  bool is_possible(TaskId task, Signal signal) const noexcept;
  Nanoseconds next_due() const noexcept;

 private:
  std::uint64_t last_ = 0;
  std::vector<std::vector<PendingSignal>> tasks_;
};

/// Result of one signal for one task, or the reason why no report will come.
struct SignalResult {
  std::uint64_t command = 0;
  TaskId task;
  Signal signal = Signal::kOn;
  State before{}, after{};
  SignalRefusal refusal;

  /// True if the signal was carried out and the task is in the state to which it leads.
  bool is_done() const noexcept { return !refusal.is_refused(); }
};

/// Context: setup.
struct SubsystemState {
  explicit SubsystemState(const ApplicationSpec& application);

  const ApplicationSpec& spec;
  const Variables variables;
  HeapMemory memory;  ///< memory of `rivals`
  Rivals rivals;
  ObservedState observed;
  PendingSignals pending;
  bool is_complete = false;                ///< InventoryComplete has come
  Nanoseconds complete_since;              ///< when it came
  Nanoseconds now;                         ///< time of this step
  std::vector<Action>* actions = nullptr;  ///< actions of this step

  std::string name(TaskId task) const { return std::string(spec.tasks[task.index].name); }
  std::string name(RtpuId rtpu) const { return std::string(spec.rtpus[rtpu.index].name); }
  template <class OneAction>
  void emit(OneAction action) const {
    actions->emplace_back(std::move(action));
  }
  void log(const char* kind, TaskId task, RtpuId rtpu, std::string text) const;
  /// Sends the signal and returns the number of the command. All tasks must belong to one rtpu.
  std::uint64_t send(Signal signal, std::span<const TaskId> tasks);

  /// The tasks without repetition, in data-flow order or in reverse.
  std::vector<TaskId> sorted(std::span<const TaskId> tasks, bool backwards = false) const;

  /// True if the task is ON or may be: its process does not serve this manager, or an `on` is pending.
  bool may_be_on(TaskId task) const;
  /// True if a signal that may change the task is pending, or its init or kill runs.
  bool is_busy(TaskId task) const;
  /// True if a spawn is pending, or init or kill runs.
  bool is_spawning(TaskId task) const;

  /// A task that shares a resource with `task` and is, or may be, created; invalid if there is none.
  TaskId find_rival(TaskId task) const;
  /// "hand has the resource '/dev/tool' of gripper, which is ON", "type `chimera switch assembly`".
  SignalRefusal rivalry(TaskId task, TaskId rival) const;

  /// Reason why the present ON tasks and `tasks` together are not a legal set or take too much of a CPU; otherwise
  /// kNone. For an illegal set it has the tasks to turn ON instead of `tasks`, if a legal set holds them.
  SignalRefusal judge_on(std::span<const TaskId> tasks) const;
  /// Refusal of a signal for `tasks`, because `task` is in the wrong state: "pi is in state ERROR, where on is not
  /// legal", "type `chimera clear pi`, then `chimera on pi`".
  SignalRefusal illegal(Signal signal, TaskId task, State state, std::span<const TaskId> tasks) const;
  SignalRefusal no_answer(TaskId task) const;
  /// "servo ended by signal 11".
  SignalRefusal ended(RtpuId rtpu, const std::string& cause) const;
  /// The refusal of a signal. The reason of a fault names signal and task: "spawn: pid: no memory".
  SignalRefusal named(const SignalResult& result) const;
  /// Variables that a task that is ON reads and no task that is ON writes, and variables with two such writers: "u (pi
  /// is OFF)"; "" if there are none.
  std::string missing() const;
};

/// True if `signal` is legal in `state`.
bool is_legal(State state, Signal signal) noexcept;

}  // namespace chimera::subsystem
