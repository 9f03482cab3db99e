// SPDX-License-Identifier: Apache-2.0
// For tests: a small application on two rtpus, events by name, actions as text.
#pragma once

#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "chimera/runtime/testing/named_links.h"
#include "chimera/subsystem/subsystem.h"

namespace chimera::subsystem {

/// arm (hardware, makes ndof) and pid on servo; traj and reserve on spare; pid and reserve both produce tau.
class TestWorld {
 public:
  TestWorld() {
    add("arm", 0, {{CHIMERA_IN_VAR, "tau"}, {CHIMERA_OUT_VAR, "q"}, {CHIMERA_OUT_CONST, "ndof"}}).is_hardware = true;
    add("pid", 0,
        {{CHIMERA_IN_VAR, "q"}, {CHIMERA_IN_VAR, "ref"}, {CHIMERA_OUT_VAR, "tau"}, {CHIMERA_IN_CONST, "ndof"}});
    add("traj", 1, {{CHIMERA_OUT_VAR, "ref"}});
    add("reserve", 1, {{CHIMERA_IN_VAR, "q"}, {CHIMERA_OUT_VAR, "tau"}, {CHIMERA_IN_CONST, "ndof"}});
    for (std::size_t t = 0; t < tasks_.size(); ++t) tasks_[t].ports = ports_[t];
    spec.name = "test";
    spec.rtpus = rtpus_;
    spec.tasks = tasks_;
    spec.init_order = init_order_;
    spec.start = start_;
    links_.finish(spec);
    remembered.goals.resize(tasks_.size());
    remembered.handled.resize(rtpus_.size());
    remembered.restarts.resize(rtpus_.size());
    subsystem = std::make_unique<Subsystem>(spec);
  }

  static constexpr TaskId kArm{0u}, kPid{1u}, kTraj{2u}, kReserve{3u};
  static constexpr RtpuId kServo{0u}, kSpare{1u};

  /// The actions that follow from the event, one a line.
  std::string step(const Event& event) {
    std::vector<Action> actions;
    subsystem->step(event, now, actions);
    return lines(actions);
  }
  std::string lines(const std::vector<Action>& actions) {
    std::string text;
    for (const Action& action : actions) text += line(action);
    return text;
  }
  std::string seen(TaskId task, State state, bool in_service = false) {
    states[task.index] = state;
    return step(TaskSeen{task, {state, in_service, 1}});
  }
  /// The task goes to `after`, and its rtpu reports on the last signal for it.
  std::string report(TaskId task, State after, std::string text = {}) {
    const Reported& last = sent[task.index];
    const State before = states[task.index];
    std::string actions = seen(task, after);
    Reported told{last.command, task, last.signal, true, Refusal::kNone, before, after, std::move(text)};
    return actions + step(told);
  }
  std::string refuse(TaskId task, Refusal why, std::string text = {}) {
    const Reported& last = sent[task.index];
    const State state = states[task.index];
    return step(Reported{last.command, task, last.signal, false, why, state, state, std::move(text)});
  }
  std::string command(Signal signal, std::vector<TaskId> tasks) {
    return step(Commanded{++commands, signal, std::move(tasks)});
  }
  std::string die(RtpuId rtpu, std::uint32_t incarnation = 1) {
    for (std::size_t t = 0; t < tasks_.size(); ++t)
      if (tasks_[t].rtpu == rtpu) states[TaskId(t).index] = State::kNotCreated;
    return step(RtpuDown{rtpu, incarnation, "ended by signal 11 (SIGSEGV) in pid.cycle"});
  }
  /// Everything is spawned and the start set is ON.
  void start() {
    step(remembered);
    step(RtpuUp{kServo, 1});
    step(RtpuUp{kSpare, 1});
    step(InventoryComplete{});
    for (TaskId task : {kArm, kTraj, kPid, kReserve}) report(task, State::kOff);
    for (TaskId task : {kArm, kTraj, kPid}) report(task, State::kOn);
  }
  void set_budget(TaskId task, Nanoseconds budget) { tasks_[task.index].budget = budget; }
  /// From now on pid and reserve open the same device; nothing has begun.
  void make_rivals() {
    for (const TaskId task : {kPid, kReserve}) {
      PortSpec port;
      port.kind = CHIMERA_RESOURCE;
      port.value = device_;
      ports_[task.index].push_back(port);
      tasks_[task.index].ports = ports_[task.index];
      tasks_[task.index].is_hardware = true;
    }
    spec.sets = sets_;
    subsystem = std::make_unique<Subsystem>(spec);
  }
  /// From now on pid and reserve open the same device, and reserve is a standby of pid.
  void make_standby() {
    spec.standbys = standbys_;
    make_rivals();
  }
  /// The manager dies, and another one finds the processes as they are.
  std::string rebirth() {
    subsystem = std::make_unique<Subsystem>(spec);
    return step(remembered);
  }

  ApplicationSpec spec;
  Begun remembered;
  Nanoseconds now{seconds(100)};
  std::unique_ptr<Subsystem> subsystem;
  std::map<std::uint32_t, State> states;
  std::map<std::uint32_t, Reported> sent;  // the last by task
  std::uint64_t commands = 0;

 private:
  TaskSpec& add(const char* name, std::uint32_t rtpu, std::vector<std::pair<std::uint32_t, const char*>> ports) {
    auto& mine = ports_.emplace_back();
    for (const auto& [kind, variable] : ports) {
      PortSpec port;
      port.kind = kind;
      links_.link(port, variable);
      mine.push_back(port);
    }
    TaskSpec& task = tasks_.emplace_back();
    task.name = name;
    task.rtpu = RtpuId(rtpu);
    task.period = task.deadline = milliseconds(1);
    return task;
  }
  std::string names(const std::vector<TaskId>& tasks) const {
    std::string text;
    for (TaskId task : tasks) text += " " + std::string(spec.tasks[task.index].name);
    return text;
  }
  std::string name(RtpuId rtpu) const { return std::string(spec.rtpus[rtpu.index].name); }
  std::string name(TaskId task) const { return std::string(spec.tasks[task.index].name); }

  std::string line(const Action& action) {
    std::ostringstream out;
    if (const auto* send = std::get_if<Send>(&action)) {
      out << "send " << name(send->rtpu) << ": " << signal_name(send->signal) << names(send->tasks);
      for (TaskId task : send->tasks) {
        sent[task.index].command = send->command;
        sent[task.index].signal = send->signal;
      }
    } else if (const auto* start_it = std::get_if<StartRtpu>(&action)) {
      out << "start " << name(start_it->rtpu);
    } else if (const auto* goal = std::get_if<RememberGoal>(&action)) {  // without the word of a person
      const std::uint32_t before = std::exchange(remembered.goals[goal->task.index], goal->goal);
      if ((before ^ goal->goal) == kGoalOff) return "";
      out << "goal " << name(goal->task) << " " << (goal->goal & ~kGoalOff);
    } else if (const auto* handled = std::get_if<RememberHandled>(&action)) {
      remembered.handled[handled->rtpu.index] = handled->incarnation;
      out << "handled " << name(handled->rtpu) << " " << handled->incarnation;
    } else if (const auto* restart = std::get_if<RememberRestart>(&action)) {
      remembered.restarts[restart->rtpu.index] = restart->instants;
      out << "restart " << name(restart->rtpu);
    } else if (std::holds_alternative<RememberStarted>(action)) {
      remembered.started = true;
      out << "remember started";
    } else if (const auto* answer = std::get_if<CommandAnswer>(&action)) {
      out << "answer " << answer->id << (answer->is_accepted() ? " yes" : " no: ") << answer->refusal.text();
      for (const TaskOutcome& outcome : answer->outcomes)
        out << " " << name(outcome.task) << " " << state_name(outcome.before) << ">" << state_name(outcome.after)
            << (outcome.is_already ? " already" : "");
    } else if (const auto* tell = std::get_if<LogEvent>(&action)) {
      out << tell->kind << ": " << tell->text;
    }
    return out.str() + "\n";
  }

  const std::byte device_[4] = {std::byte{'t'}, std::byte{'t'}, std::byte{'y'}, std::byte{'0'}};
  StandbySpec standbys_[1] = {{kPid, kReserve}};
  std::vector<TaskId> by_pid_{kArm, kTraj, kPid}, by_reserve_{kArm, kReserve};
  NamedSet sets_[2] = {{"run", by_pid_}, {"careful", by_reserve_}};
  std::vector<RtpuSpec> rtpus_{{"servo", 0, Policy::kEdf}, {"spare", 1, Policy::kEdf}};
  std::vector<TaskSpec> tasks_;
  std::vector<std::vector<PortSpec>> ports_;
  chimera::NamedLinks links_;
  std::vector<TaskId> init_order_{kArm, kPid, kTraj, kReserve};
  std::vector<TaskId> start_{kArm, kTraj, kPid};
};

}  // namespace chimera::subsystem
