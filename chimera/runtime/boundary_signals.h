// SPDX-License-Identifier: Apache-2.0
// The signals that an edge carries out: of the script, of tasks, and of whoever takes part in the edge. All of them are
// recorded on the tap.
#pragma once

#include <span>

#include "chimera/base/fixed.h"
#include "chimera/runtime/boundary_listener.h"
#include "chimera/runtime/context_tap.h"
#include "chimera/runtime/job_threads.h"
#include "chimera/runtime/run_options.h"
#include "chimera/runtime/settlement.h"
#include "chimera/runtime/switch/local_switches.h"
#include "chimera/runtime/switch/switching.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// A signal that was refused, from the script or from a task.
struct RefusedSignal {
  Nanoseconds at;  ///< on the executor's clock
  TaskId task;
  Signal signal = Signal::kOn;
  Refusal why = Refusal::kNone;
  State state = State::kNotCreated;  ///< of the task, then
};

inline constexpr std::size_t kRefusedKept = 64;

/// The same request of a task is passed on again after this time. It waits until then, and gives way to another one.
inline constexpr Nanoseconds kAskAgain = milliseconds(100);

/// Context of everything not marked: edge; as long as the methods of components take; no allocation but theirs.
class BoundarySignals {
 public:
  /// Everything given outlives this, but `options`, whose script is kept and whose guest is told. Context: setup.
  BoundarySignals(TaskSet& set, const RunOptions& options, ContextTap& tap, Settlement& settlement, JobThreads& threads,
                  Switching& switching) noexcept
      : set_(set), script_(options.script), tap_(tap), settlement_(settlement), threads_(threads),
        switching_(switching), guest_(options.guest) {}
  /// Switches are ordered here, by these, which outlive this; else elsewhere. Context: setup.
  void order_by(LocalSwitches& switches) noexcept { orders_ = &switches; }

  /// The script counts from `origin`.
  void begin(Nanoseconds origin) noexcept;
  /// From when on an edge has something to do: an act of the script, a step of a switch, a standby that has not come;
  /// kNever: nothing is left.
  /// Context: cycle; wait-free.
  Nanoseconds next_act() const noexcept { return next_act_; }
  /// The same while jobs wait, none of which is under way at an edge. Context: cycle; wait-free.
  Nanoseconds next_act_in_row() const noexcept { return next_act_in_row_; }
  /// The next instant at which that is so although no job ends before. Context: cycle; wait-free.
  Nanoseconds next_wake() const noexcept { return next_wake_; }
  /// All of an edge is done: next_act() and next_wake() anew; `due` and `wake` are those of Recovery.
  void look_ahead(Nanoseconds due, Nanoseconds wake) noexcept;
  /// Carries out the acts of the script that are due, and step().
  void act(Nanoseconds now) noexcept;
  /// Goes on with a switch that is under way, and begins the one that a task asked for last.
  void step(Nanoseconds now) noexcept;
  /// Carries out an act of a script that is kept elsewhere; not kDie.
  void act(const ScriptAct& act, Nanoseconds now) noexcept;
  /// Carries out the signals that tasks sent to tasks of this context; those for a task with an unfinished job wait.
  void carry_out_pending(Nanoseconds now) noexcept;

  /// True when an edge may touch the task now: no job of it is under way.
  bool may_touch(TaskId task) noexcept { return threads_.claim(task); }
  /// As TaskLife::signal. Requires: may_touch() of all.
  SignalReport signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now) noexcept;
  /// As TaskLife::warm_up. Requires: may_touch().
  void warm_up(TaskId task, Nanoseconds now) noexcept;
  /// As TaskLife::finish_slow.
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
  Switching& switching_;
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
