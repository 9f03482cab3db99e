// SPDX-License-Identifier: Apache-2.0
// Keeps the signals that wait for a report, with their time limits. Also holds the questions and refusals that several
// parts share.
#include "chimera/subsystem/subsystem_state.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/hosted/together.h"
#include "chimera/subsystem/remedy.h"

namespace chimera::subsystem {

std::uint64_t PendingSignals::post(Signal signal, std::span<const TaskId> tasks, Nanoseconds now) {
  ++last_;
  for (TaskId task : tasks) of(task).push_back({last_, signal, now, now + kAnswerLimit});
  return last_;
}

bool PendingSignals::settle(TaskId task, std::uint64_t command) {
  auto& list = of(task);
  const auto mine = [command](const PendingSignal& entry) { return entry.command == command; };
  const auto found = std::find_if(list.begin(), list.end(), mine);
  if (found == list.end()) return false;
  const bool was_awaited = found->due != kNever;
  const auto is_given_up = [](const PendingSignal& entry) { return entry.due == kNever; };
  list.erase(std::remove_if(list.begin(), found, is_given_up), found);
  std::erase_if(list, mine);
  return was_awaited;
}

bool PendingSignals::is_awaited(TaskId task) const noexcept {
  const auto& list = tasks_[task.index];
  return std::any_of(list.begin(), list.end(), [](const PendingSignal& entry) { return entry.due != kNever; });
}

bool PendingSignals::is_awaited(TaskId task, Signal signal) const noexcept {
  const auto& list = tasks_[task.index];
  return std::any_of(list.begin(), list.end(),
                     [signal](const PendingSignal& entry) { return entry.signal == signal && entry.due != kNever; });
}

bool PendingSignals::is_possible(TaskId task, Signal signal) const noexcept {
  const auto& list = tasks_[task.index];
  return std::any_of(list.begin(), list.end(), [signal](const PendingSignal& entry) { return entry.signal == signal; });
}

Nanoseconds PendingSignals::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (const auto& list : tasks_)
    for (const PendingSignal& entry : list) next = std::min(next, entry.due);
  return next;
}

SubsystemState::SubsystemState(const ApplicationSpec& application)
    : spec(application), variables(application), observed(application), pending(application.tasks.size()) {
  rivals.prepare(spec, memory);
}

void SubsystemState::log(const char* kind, TaskId task, RtpuId rtpu, std::string text) const {
  emit(LogEvent{kind, task, rtpu, std::move(text)});
}

std::uint64_t SubsystemState::send(Signal signal, std::span<const TaskId> tasks) {
  const std::uint64_t command = pending.post(signal, tasks, now);
  emit(Send{observed.rtpu(tasks.front()), command, signal, {tasks.begin(), tasks.end()}});
  return command;
}

std::vector<TaskId> SubsystemState::sorted(std::span<const TaskId> tasks, bool backwards) const {
  std::vector<TaskId> result;
  for (TaskId task : spec.on_order)
    if (std::find(tasks.begin(), tasks.end(), task) != tasks.end()) result.push_back(task);
  if (backwards) std::reverse(result.begin(), result.end());
  return result;
}

// True also for a process that does not serve this manager yet: it may be silent and still carry out posts of an
// earlier manager.
bool SubsystemState::may_be_on(TaskId task) const {
  const State seen = observed.status(task).state;
  return seen == State::kOn || pending.is_possible(task, Signal::kOn) ||
         (observed.life_of(task) == RtpuLife::kUnknown && (seen == State::kOff || !observed.is_seen(task)));
}

bool SubsystemState::is_busy(TaskId task) const { return pending.is_awaited(task) || observed.status(task).in_service; }

bool SubsystemState::is_spawning(TaskId task) const {
  return pending.is_awaited(task, Signal::kSpawn) || observed.status(task).in_service;
}

SignalRefusal SubsystemState::judge_on(std::span<const TaskId> tasks) const {
  std::vector<bool> on(spec.tasks.size());
  for (std::size_t t = 0; t < on.size(); ++t) on[t] = may_be_on(TaskId(t));
  for (TaskId task : tasks) on[task.index] = true;
  if (!variables.is_legal(on)) {
    const std::vector<bool> smallest = variables.smallest_legal(on);
    SignalRefusal refusal{RefusalKind::kSet, variables.fault(on, spec.tasks), Variables::remedy(smallest, spec.tasks)};
    for (const TaskId task : spec.on_order) {
      const bool is_needed = !smallest.empty() && smallest[task.index];
      if (is_needed && observed.state(task) != State::kOn) refusal.tasks.push_back(task);
    }
    return refusal;
  }
  std::vector<TaskId> set;
  for (const TaskId task : spec.on_order)
    if (observed.state(task) == State::kOn || pending.is_possible(task, Signal::kOn) ||
        std::ranges::count(tasks, task) > 0)
      set.push_back(task);
  if (const auto excess = excess_of(spec, set))
    return {RefusalKind::kSet, excess_text(spec, *excess), "turn other tasks of that CPU OFF"};
  return {};
}

TaskId SubsystemState::find_rival(TaskId task) const {
  for (const TaskId rival : spec.on_order) {
    const RtpuLife life = observed.life_of(rival);
    if (!rivals.are(task, rival) || (life != RtpuLife::kUp && life != RtpuLife::kUnknown)) continue;
    const bool is_held = observed.is_created(rival) || observed.status(rival).in_service;
    if (is_held || pending.is_possible(rival, Signal::kSpawn)) return rival;
  }
  return {};
}

SignalRefusal SubsystemState::rivalry(TaskId task, TaskId rival) const {
  std::string commands = "`chimera kill " + name(rival) + "`, then `chimera spawn " + name(task) + "`";
  for (const NamedSet& set : spec.sets)
    if (std::find(set.order.begin(), set.order.end(), task) != set.order.end()) {
      commands = "`chimera switch " + std::string(set.name) + "`";
      break;
    }
  return {RefusalKind::kResource,
          name(task) + " has the resource '" + std::string(rivals.resource(task, rival)) + "' of " + name(rival) +
              ", which is " + state_name(observed.state(rival)),
          typed(commands)};
}

SignalRefusal SubsystemState::illegal(Signal signal, TaskId task, State state, std::span<const TaskId> tasks) const {
  if (const TaskId rival = find_rival(task); state == State::kNotCreated && rival.is_valid())
    return rivalry(task, rival);
  return {RefusalKind::kState,
          name(task) + " is in state " + state_name(state) + ", where " + signal_name(signal) + " is not legal",
          typed(remedy(*this, signal, tasks))};
}

SignalRefusal SubsystemState::no_answer(TaskId task) const {
  return {RefusalKind::kNoAnswer, "no answer from rtpu " + name(observed.rtpu(task)), {}};
}

SignalRefusal SubsystemState::ended(RtpuId rtpu, const std::string& cause) const {
  return {RefusalKind::kEnded, name(rtpu) + " " + cause, {}};
}

SignalRefusal SubsystemState::named(const SignalResult& result) const {
  if (result.refusal.kind != RefusalKind::kFault) return result.refusal;
  return result.refusal.behind(std::string(signal_name(result.signal)) + ": " + name(result.task) + ": ");
}

std::string SubsystemState::missing() const {
  const auto is_on = [this](TaskId task) { return observed.state(task) == State::kOn; };
  std::string text;
  for (const Variable& variable : variables.all()) {
    const SetFault fault = set_fault(variable, is_on);
    if (fault == SetFault::kNone) continue;
    std::string who;
    for (const PortOf& port : variable.producers)
      if (fault == SetFault::kNoProducer || is_on(port.task))
        append_joined(who, ", ", name(port.task) + " is " + state_name(observed.state(port.task)));
    append_joined(text, "; ", std::string(variable.name) + (who.empty() ? "" : " (" + who + ")"));
  }
  return text;
}

bool is_legal(State state, Signal signal) noexcept {
  return next(state, signal, false).kind != Next::Kind::kImpossible;
}

}  // namespace chimera::subsystem
