// SPDX-License-Identifier: Apache-2.0
// Carries out the steps of a slow switch (slow_plan.h) on the tasks of one context: each forwards, and back.
// runtime/switch/slow_switch.h decides whose turn it is, and reacts to a step that fails.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/life/settlement.h"
#include "chimera/runtime/plan/idle_gap.h"
#include "chimera/runtime/plan/slow_plan.h"
#include "chimera/runtime/record/context_tap.h"
#include "chimera/runtime/switch/switch_record.h"
#include "chimera/task/state_machine.h"

namespace chimera {

/// How far a step is.
enum class StepEnd : std::uint8_t { kDone, kWaits, kFailed };

/// The steps that spawn and kill tasks, over several cycle boundaries if a service thread runs `init` and `kill`.
/// Remembers the steps that were carried out, so that only those are undone. Context of everything not marked: cycle
/// boundary; wait-free. `Move`, which is given the task and the signal, calls the methods.
class CreationSteps {
 public:
  /// Context: setup.
  void prepare(std::size_t n_tasks, SetupMemory& memory);
  /// Begins another switch: forgets all steps that were done.
  void begin() noexcept;
  /// The task is handed over to the service thread by one of these steps.
  bool is_under_way(TaskId task) const noexcept { return asked_ == task; }

  /// `signal` is kSpawn or kKill. kDone at once if there is nothing to do. kFailed: nothing is to be undone.
  template <class Move>
  StepEnd carry_out(Task& task, Signal signal, Move move) {
    if (asked_ != task.id && task.state == after(signal)) return StepEnd::kDone;
    if (const StepEnd end = go_on(task, signal, move); end != StepEnd::kDone) return end;
    if (task.state != after(signal)) return StepEnd::kFailed;
    mark(task.id, signal, true);
    return StepEnd::kDone;
  }
  /// Takes a step back that was carried out here, or was under way when the switch was aborted. kDone also if the other
  /// method failed. Requires: the service thread does not have the task.
  template <class Move>
  StepEnd undo(Task& task, Signal signal, Move move) {
    if (asked_ == task.id && asked_for_ == signal) {
      asked_ = TaskId();
      mark(task.id, signal, true);
    }
    if (!is_done(task.id, signal)) return StepEnd::kDone;
    const Signal back = signal == Signal::kSpawn ? Signal::kKill : Signal::kSpawn;
    if (asked_ != task.id && next(task.state, back, false).kind == Next::Kind::kImpossible) return StepEnd::kDone;
    if (go_on(task, back, move) == StepEnd::kWaits) return StepEnd::kWaits;
    mark(task.id, signal, false);
    return StepEnd::kDone;
  }

 private:
  static State after(Signal signal) noexcept { return signal == Signal::kSpawn ? State::kOff : State::kNotCreated; }
  template <class Move>
  StepEnd go_on(Task& task, Signal signal, Move move) {
    if (asked_ != task.id) {
      asked_ = task.id;
      asked_for_ = signal;
      move(task, signal);
    }
    if (task.in_service()) return StepEnd::kWaits;
    asked_ = TaskId();
    return StepEnd::kDone;
  }
  bool is_done(TaskId task, Signal signal) const noexcept { return of(signal)[task.index]; }
  void mark(TaskId task, Signal signal, bool is_done) noexcept { of(signal)[task.index] = is_done; }
  std::span<bool> of(Signal signal) const noexcept { return signal == Signal::kSpawn ? spawned_ : killed_; }

  std::span<bool> spawned_, killed_;  // by task
  TaskId asked_;
  Signal asked_for_ = Signal::kSpawn;
};

/// Reason why a step failed, or why its result is not acceptable. Plain value.
struct StepFailure {
  NoSwitch why = NoSwitch::kNone;
  TaskId task;
  VariableId variable;
  FixedString<160> said;  ///< by the method
};

/// Context of everything not marked: cycle boundary; as long as the methods of components take; no allocation but
/// theirs.
class SlowSteps {
 public:
  /// The parts outlive SlowSteps.
  struct Parts {
    TaskSet& set;
    JobThreads& threads;
    Settlement& settlement;
    ContextTap& tap;
    JobClock& clock;
    IdleGap& gap;
    SwitchRecord& record;
  };
  explicit SlowSteps(const Parts& parts) noexcept : parts_(parts) {}
  /// Context: setup.
  void prepare() { created_.prepare(parts_.set.tasks().size(), parts_.set.setup_memory()); }
  /// Begins another order, which outlives the switch.
  void begin(const SwitchOrder& order) noexcept;

  /// Carries out a step of a task of this context, once or until it is no longer kWaits. failure() may demand an abort
  /// of the switch even if the step is kDone.
  StepEnd carry_out(const SlowStep& step, Nanoseconds now) noexcept;
  const StepFailure& failure() const noexcept { return failure_; }
  /// The step was begun, and carry_out() has not ended it: undo() takes it back, too.
  bool has_begun(const SlowStep& step) const noexcept;
  /// Takes back what carry_out() did. A step that cannot be undone, because a signal or an error came between, is left
  /// as it is.
  StepEnd undo(const SlowStep& step, Nanoseconds now) noexcept;
  /// The service thread has the task, for one of these steps.
  bool is_under_way(TaskId task) const noexcept { return created_.is_under_way(task); }
  /// When to try a waiting step again although no bell rings and no job ends.
  Nanoseconds wake() const noexcept { return wake_; }

 private:
  StepEnd check(const Task& task) noexcept;
  StepEnd turn_off(Task& task, Nanoseconds now) noexcept;
  StepEnd create(Task& task, Signal signal, Nanoseconds now) noexcept;
  StepEnd reinit(Task& task, Nanoseconds now) noexcept;
  StepEnd turn_on(Task& task, Nanoseconds now) noexcept;
  StepEnd turn_on_again(Task& task, Nanoseconds now) noexcept;
  StepEnd fail(NoSwitch why, const Task& task) noexcept;
  StepEnd wait_until(Nanoseconds instant) noexcept;
  bool waits_for_idle(Nanoseconds now) noexcept;
  bool waits_for_gap(const Task& task, Method method, Nanoseconds now) noexcept;
  bool waits_for_device(const Task& task, Nanoseconds now) noexcept;
  SignalReport move(Task& task, Signal signal, Nanoseconds now) noexcept;
  Task& task(TaskId id) noexcept { return parts_.set.tasks()[id.index]; }

  Parts parts_;
  CreationSteps created_;
  StepFailure failure_;
  const SwitchOrder* order_ = nullptr;
  Nanoseconds wake_ = kNever;
  Nanoseconds waits_since_ = kNever;  // for a gap
  Nanoseconds again_at_ = kNever;     // instant of the next call of a device that is not ready
  Nanoseconds back_until_ = kNever;   // end of the waits for a device on the way back
  bool was_idle_ = false;             // the processor, since the leaving tasks are OFF
};

}  // namespace chimera
