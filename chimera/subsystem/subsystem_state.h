// SPDX-License-Identifier: Apache-2.0
// What the parts of a Subsystem share: the application, what is known of it, which signals are pending, where actions
// go.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/switch/rivals.h"
#include "chimera/subsystem/observed_state.h"
#include "chimera/subsystem/subsystem.h"

namespace chimera::subsystem {

/// A signal that was sent and is not reported on yet.
struct PendingSignal {
  std::uint64_t command = 0;
  Signal signal = Signal::kOn;
  Nanoseconds sent;
  Nanoseconds due;  ///< kNever: given up waiting, though it may still be carried out
};

/// Posts of one sender to one rtpu are taken in their order: a report on one tells that all before it were taken, so
/// that those given up are over too. Context: setup.
class PendingSignals {
 public:
  explicit PendingSignals(std::size_t n_tasks) : tasks_(n_tasks) {}

  /// Numbers never repeat, over managers too: each begins at its own instant of start.
  void begin(Nanoseconds now) noexcept { last_ = now.count > 0 ? static_cast<std::uint64_t>(now.count) : 0; }
  /// Returns the number of the command.
  std::uint64_t post(Signal signal, std::span<const TaskId> tasks, Nanoseconds now);
  /// Takes the entry of `command` away. False: nobody waits for it any more.
  bool settle(TaskId task, std::uint64_t command);
  void drop(TaskId task) { tasks_[task.index].clear(); }

  std::vector<PendingSignal>& of(TaskId task) noexcept { return tasks_[task.index]; }
  /// Is an answer awaited?
  bool is_awaited(TaskId task) const noexcept;
  bool is_awaited(TaskId task, Signal signal) const noexcept;
  /// Sent and not known to be over, given up or not.
  bool is_possible(TaskId task, Signal signal) const noexcept;
  Nanoseconds next_due() const noexcept;

 private:
  std::uint64_t last_ = 0;
  std::vector<std::vector<PendingSignal>> tasks_;
};

/// What became of one signal for one task, or why nothing will be heard of it.
struct SignalResult {
  std::uint64_t command = 0;
  TaskId task;
  Signal signal = Signal::kOn;
  State before{}, after{};
  SignalRefusal refusal;

  /// Carried out, and ended in the state to which the signal leads.
  bool is_done() const noexcept { return !refusal.is_refused(); }
};

/// Context: setup.
struct SubsystemState {
  explicit SubsystemState(const ApplicationSpec& application);

  const ApplicationSpec& spec;
  const Variables variables;
  HeapMemory memory;  ///< behind the rivals
  Rivals rivals;
  ObservedState observed;
  PendingSignals pending;
  bool is_complete = false;                ///< InventoryComplete has come
  Nanoseconds complete_since;              ///< when it came
  Nanoseconds now;                         ///< of this step
  std::vector<Action>* actions = nullptr;  ///< of this step

  std::string name(TaskId task) const { return std::string(spec.tasks[task.index].name); }
  std::string name(RtpuId rtpu) const { return std::string(spec.rtpus[rtpu.index].name); }
  template <class OneAction>
  void emit(OneAction action) const {
    actions->emplace_back(std::move(action));
  }
  void log(const char* kind, TaskId task, RtpuId rtpu, std::string text) const;
  /// Sends and returns the number of the command. The tasks are of one rtpu.
  std::uint64_t send(Signal signal, std::span<const TaskId> tasks);

  /// Each task once, in data-flow order, or against it.
  std::vector<TaskId> sorted(std::span<const TaskId> tasks, bool backwards = false) const;

  /// Is the task ON, or might it be: its process does not serve this manager, or an `on` is pending?
  bool may_be_on(TaskId task) const;
  /// Is a signal pending that may change the task, or does its init or kill run?
  bool is_busy(TaskId task) const;
  /// Is a spawn pending, or does init or kill run?
  bool is_spawning(TaskId task) const;

  /// A task that has a resource of `task` and is, or may be, created; invalid: none.
  TaskId find_rival(TaskId task) const;
  /// "hand has the resource '/dev/tool' of gripper, which is ON", "type `chimera switch assembly`".
  SignalRefusal rivalry(TaskId task, TaskId rival) const;

  /// Why the tasks that would be ON with `tasks` are no legal set; kNone when they are.
  SignalRefusal judge_on(std::span<const TaskId> tasks) const;
  /// "pi is in state ERROR, where on is not legal", "type `chimera clear pi`, then `chimera on pi motor`": of a signal
  /// for `tasks`, one of them `task`.
  SignalRefusal illegal(Signal signal, TaskId task, State state, std::span<const TaskId> tasks) const;
  SignalRefusal no_answer(TaskId task) const;
  /// "servo ended by signal 11".
  SignalRefusal ended(RtpuId rtpu, const std::string& cause) const;
  /// The refusal of a signal; that of a fault names signal and task: "spawn: pid: no memory".
  SignalRefusal named(const SignalResult& result) const;
  /// "u (pi is OFF)": what a task that is ON reads and nobody that is ON writes, and what two write; "" when all is
  /// well.
  std::string missing() const;
};

/// Is `signal` legal in `state`?
bool is_legal(State state, Signal signal) noexcept;

}  // namespace chimera::subsystem
