// SPDX-License-Identifier: Apache-2.0
// What the parts of a Subsystem share: the application, what is known, what is under way, and where actions go.
#pragma once

#include <string>
#include <vector>

#include "chimera/runtime/variables.h"
#include "chimera/subsystem/mail.h"
#include "chimera/subsystem/roster.h"
#include "chimera/subsystem/subsystem.h"

namespace chimera::subsystem {

/// What became of one signal for one task, or why nothing will be heard of it.
struct Reply {
  std::uint64_t command = 0;
  TaskId task;
  Signal signal = Signal::kOn;
  bool is_done = false;   ///< carried out and ended where the signal leads
  bool is_death = false;  ///< the process died before it told
  bool is_fault = false;  ///< a method failed
  State before{}, after{};
  std::string why;        ///< when not done; "": another of the same list was at fault
};

/// Context: setup.
struct Situation {
  explicit Situation(const ApplicationSpec& application);

  const ApplicationSpec& spec;
  const Variables variables;
  const std::vector<TaskId> order;                ///< data flow
  const std::vector<std::vector<TaskId>> makers;  ///< of constants, by task
  Roster roster;
  Mail mail;
  bool is_complete = false;  ///< the inventory is
  Nanoseconds complete_since;
  Nanoseconds now;
  std::vector<Action>* actions = nullptr;

  std::string name(TaskId task) const { return std::string(spec.tasks[task.index].name); }
  std::string name(RtpuId rtpu) const { return std::string(spec.rtpus[rtpu.index].name); }
  template <class OneAction>
  void act(OneAction action) const {
    actions->emplace_back(std::move(action));
  }
  void tell(const char* kind, TaskId task, RtpuId rtpu, std::string text) const;
  /// Sends and returns the number of the command. The tasks are of one rtpu.
  std::uint64_t send(Signal signal, std::span<const TaskId> tasks);

  /// Each task once, in data-flow order, or against it.
  std::vector<TaskId> sorted(std::span<const TaskId> tasks, bool backwards = false) const;

  /// Is it ON, or might it be for all we know?
  bool may_be_on(TaskId task) const;
  /// Is a signal under way that may change the task, or init or kill?
  bool is_busy(TaskId task) const;
  /// Why the tasks that would be ON with `tasks` are no legal set; "" when they are.
  std::string judge_on(std::span<const TaskId> tasks) const;
  /// "pi is in state ERROR, where on is not legal; type `chimera clear pi`, then `chimera on pi motor`": of a signal
  /// for `tasks`, one of them `task`.
  std::string illegal(Signal signal, TaskId task, State state, std::span<const TaskId> tasks) const;
  /// "u (pi is OFF)": what a task that is ON reads and nobody that is ON writes, and what two write; "" when all is
  /// well.
  std::string missing() const;
  /// Why a signal failed: "spawn: pid: no memory".
  std::string sentence(const Reply& reply) const;
  std::string no_answer(TaskId task) const { return "no answer from rtpu " + name(roster.rtpu(task)); }
};

/// Is `signal` legal in `state`?
bool is_legal(State state, Signal signal) noexcept;

}  // namespace chimera::subsystem
