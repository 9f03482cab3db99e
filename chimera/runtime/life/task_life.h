// SPDX-License-Identifier: Apache-2.0
// The life of the tasks of one context: one signal, the steps of the state machine that it starts
// (chimera/task/state_machine.h), and what follows for the other tasks.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/job/job_clock.h"
#include "chimera/runtime/life/signal_judge.h"
#include "chimera/runtime/refusal.h"
#include "chimera/task/task.h"

namespace chimera {

class TaskSet;

/// Result of a signal. Plain data: no text is made on the cycle path; explain() makes it.
struct SignalReport {
  bool is_accepted = false;
  bool is_deferred = false;  ///< the service thread has it: the rest comes from TaskLife::finish_slow()
  Refusal why = Refusal::kNone;
  Signal signal = Signal::kOn;
  TaskId task;  ///< the one it failed at, else the last
  State before = State::kNotCreated;
  State after = State::kNotCreated;
  std::uint32_t set = UINT32_MAX;  ///< of kSwitch: its target, in ApplicationSpec::sets; UINT32_MAX: none of them

  explicit operator bool() const noexcept { return is_accepted; }
};

/// Acts on the tasks that a TaskSet holds. Context of everything not marked: cycle boundary; as long as methods take.
class TaskLife {
 public:
  explicit TaskLife(TaskSet& set) noexcept : set_(set), judge_(set) {}
  /// The spec is that of the set, and outlives this. Context: setup.
  void prepare(const ApplicationSpec& spec, SetupMemory& memory);

  /// Spawns the tasks that are created at the start (Rivals), in the order of their constants, and turns the start set
  /// ON as one transaction. Reports the first task that said no; whatever was spawned stays as it is. In words:
  /// refusal_text.h.
  SignalReport start(Nanoseconds now);
  /// Starts the tasks as start(now) does. If `on` of a task answers "not yet", asks again, for at most kReadyLimit.
  /// `wait` returns the time at about the instant that it is given.
  template <class Wait>
  SignalReport start(Nanoseconds now, Wait wait) {
    SignalReport report = start(now);
    for (const Nanoseconds until = now + kReadyLimit; report.why == Refusal::kNotYet && now < until;)
      report = start(now = wait(now + kAskAgain));
    if (!report) turn_off_started(now);
    return report;
  }
  static constexpr Nanoseconds kAskAgain = milliseconds(1);
  /// Turns OFF (reverse of the start order), then kills, every task that is created.
  void shut_down(Nanoseconds now);
  /// Carries out one signal and all that follows from it (re-initialisation of users of a changed constant, the
  /// illegal-configuration flag). A refused signal changes nothing.
  SignalReport signal(TaskId task, Signal signal, Nanoseconds now) { return this->signal({&task, 1}, signal, now); }
  /// Turns tasks ON (or OFF) as one transaction: refused as a whole if the set would be illegal. If `on` of one task
  /// answers "not yet", the tasks before it are ON and those behind it were not asked: ask again for the rest.
  SignalReport signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now);
  /// Goes on with a signal after the service thread ran a method for it. Deferred again while more methods are left.
  SignalReport finish_slow(TaskId task, Nanoseconds now);
  /// A step of a slow switch: carries out the signal even if the ON tasks are then no legal set. Re-initialises no
  /// users of constants, because that is another step.
  SignalReport move(TaskId task, Signal signal, Nanoseconds now);
  /// Runs `on` of a task that is OFF, beside the task that produces its variables. The armed task takes over the
  /// present values, publishes into its own group, and stays OFF. After success it owes `off`; what it sent is not
  /// delivered. No task reads from it yet, except readers of a variable that no other task ever produced.
  SignalReport arm(TaskId task, Nanoseconds now);
  /// Runs `on` of a hot standby, which is OFF, beside the task that is ON. The standby takes over the present values,
  /// publishes into its own group, and cycles from now on without readers. The signal `on` later only connects readers;
  /// any other signal runs `off` first. What it sent is not delivered.
  SignalReport warm_up(TaskId task, Nanoseconds now);
  /// Runs the `off` that a task owes. Requires: it owes one. Any other signal to the task does this first.
  SignalReport settle_off(TaskId task, Nanoseconds now);

  /// Decides whether signals may be carried out.
  SignalJudge& judge() noexcept { return judge_; }

 private:
  /// The signal that a task is carrying out.
  struct Progress {
    SignalReport report;
    Step step = Step::kInit;
    Nanoseconds used;  // by the present step so far, transfers included
    bool has_new_constants = false;
    bool is_moved = false;  ///< by move()
  };

  SignalReport carry_out(TaskId task, Signal signal, Nanoseconds now);
  void turn_off_started(Nanoseconds now);
  SignalReport show(Task& task);
  SignalReport go_on_constructed(Task& task, Answer answer, Nanoseconds now);
  SignalReport advance(Task& task, Next at, Nanoseconds now);
  bool follow(Task& task, Next at, Nanoseconds now);
  Next conclude(Task& task, const StepRule& step, Answer answer, Nanoseconds now, Nanoseconds began);
  bool before_step(Task& task, const StepRule& step, Nanoseconds now);
  Answer after_ok(Task& task, const StepRule& step, Nanoseconds now);
  bool follow_constants(Task& task, Nanoseconds now);
  void reinit_users(TaskId of, Nanoseconds now);
  void take_over(Task& task, Nanoseconds now) noexcept;
  void tell_inherited(Task& task, std::uint32_t output, const chimera_slot& slot, Nanoseconds now) noexcept;
  std::uint64_t valid_after_on(const Task& task) const noexcept;
  Nanoseconds read_clock(Nanoseconds otherwise) const noexcept;

  TaskSet& set_;
  SignalJudge judge_;
  std::span<Progress> progress_;  // by task, or one for all
  std::uint64_t taken_over_valid_ = 0;
  bool is_arming_ = false;
  bool is_moving_ = false;
};

}  // namespace chimera
