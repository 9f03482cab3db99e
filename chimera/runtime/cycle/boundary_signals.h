// SPDX-License-Identifier: Apache-2.0
// The signals that a cycle boundary carries out: from the script, from tasks, and from the BoundaryListener. All of
// them are recorded on the tap.
#pragma once

#include <span>

#include "chimera/base/fixed.h"
#include "chimera/runtime/cycle/run_options.h"
#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/life/boundary_listener.h"
#include "chimera/runtime/life/settlement.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/record/context_tap.h"
#include "chimera/runtime/switch/local_switches.h"
#include "chimera/runtime/switch/switching.h"

namespace chimera {

/// A signal that was refused, from the script or from a task.
struct RefusedSignal {
  Nanoseconds at;  ///< on the executor's clock
  TaskId task;
  Signal signal = Signal::kOn;
  Refusal why = Refusal::kNone;
  State state = State::kNotCreated;  ///< of the task at `at`
};

inline constexpr std::size_t kRefusedKept = mechanisms::kCopies ? 64 : 4;

/// A task's repeated request is passed on after this time. While it waits, another request replaces it.
inline constexpr Nanoseconds kAskAgain = milliseconds(100);

/// Context of everything not marked: cycle boundary; as long as the methods of components take; no allocation but
/// theirs.
class BoundarySignals {
 public:
  /// `switching` null: nothing is switched. All arguments outlive this but `options`, whose script is kept and whose
  /// listener gets the reports. Context: setup.
  BoundarySignals(TaskSet& set, const RunOptions& options, ContextTap& tap, Settlement& settlement, JobThreads& threads,
                  Switching* switching) noexcept
      : set_(set), script_(options.script), tap_(tap), settlement_(settlement), threads_(threads),
        switching_(switching), guest_(options.guest) {}
  /// From now on, `switches` orders the switches; it outlives this. Without it, they are ordered elsewhere. Context:
  /// setup.
  void order_by(LocalSwitches& switches) noexcept { orders_ = &switches; }

  /// The script counts from `origin`.
  void begin(Nanoseconds origin) noexcept;
  /// The first instant at which a cycle boundary has something to do: an act of the script, a step of a switch, a
  /// standby that has not come. kNever: nothing is left. Context: cycle; wait-free.
  Nanoseconds next_act() const noexcept { return next_act_; }
  /// As next_act(), while jobs wait of which none is under way at a cycle boundary. Context: cycle; wait-free.
  Nanoseconds next_act_in_row() const noexcept { return next_act_in_row_; }
  /// The next instant with something to do even if no job ends before. Context: cycle; wait-free.
  Nanoseconds next_wake() const noexcept { return next_wake_; }
  /// Ends a cycle boundary: computes next_act() and next_wake() anew. `due` and `wake` are those of Recovery.
  void look_ahead(Nanoseconds due, Nanoseconds wake) noexcept;
  /// Carries out the acts of the script that are due, and step().
  void act(Nanoseconds now) noexcept;
  /// Goes on with a switch that is under way, and begins the one that a task asked for last.
  void step(Nanoseconds now) noexcept;
  /// Carries out an act of a script that is kept elsewhere; not kDie.
  void act(const ScriptAct& act, Nanoseconds now) noexcept;
  /// Carries out the signals that tasks sent to tasks of this context; those for a task with an unfinished job wait.
  void carry_out_pending(Nanoseconds now) noexcept;

  /// True if a cycle boundary may touch the task now: no job of it is under way.
  bool may_touch(TaskId task) noexcept { return threads_.claim(task); }
  /// Calls TaskLife::signal. Requires: may_touch() of all.
  SignalReport signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now) noexcept;
  /// Calls TaskLife::warm_up. Requires: may_touch().
  void warm_up(TaskId task, Nanoseconds now) noexcept;
  /// Calls TaskLife::finish_slow.
  SignalReport finish_slow(TaskId task, Nanoseconds now) noexcept;

  /// The first kRefusedKept signals that were refused. Context: setup.
  std::span<const RefusedSignal> refused() const noexcept { return {refused_.begin(), refused_.end()}; }

 private:
  void pass_request_on(Nanoseconds now) noexcept;
  void carry_out(Task& task, Signal signal, Nanoseconds now) noexcept;
  void ring(Task& task, Nanoseconds now) noexcept;
  void record(const SignalReport& report, bool was_illegal, Nanoseconds now) noexcept;
  void record_outcome(TaskId task, bool was_illegal, Nanoseconds now) noexcept;

  TaskSet& set_;
  Script script_;
  ContextTap& tap_;
  Settlement& settlement_;
  JobThreads& threads_;
  Switching* switching_;
  BoundaryListener* guest_;
  LocalSwitches* orders_ = nullptr;
  SwitchRequest request_;  // of a task: waits for kAskAgain
  SwitchRequest asked_;    // was passed on last; none if another one came since
  Nanoseconds asked_at_, asks_again_ = kNever;  // instants at which asked_ was, and request_ is to be, passed on
  Nanoseconds origin_;
  Nanoseconds next_act_ = kNever, next_act_in_row_ = kNever, next_wake_ = kNever;
  FixedVector<RefusedSignal, kRefusedKept> refused_;
};

}  // namespace chimera
