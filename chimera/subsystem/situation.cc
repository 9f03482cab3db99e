// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/situation.h"

#include <algorithm>

#include "chimera/subsystem/order.h"
#include "chimera/subsystem/remedy.h"

namespace chimera::subsystem {

Situation::Situation(const ApplicationSpec& application)
    : spec(application), variables(application), order(data_flow_order(application)),
      makers(makers_of_constants(application)), roster(application), mail(application.tasks.size()) {}

void Situation::tell(const char* kind, TaskId task, RtpuId rtpu, std::string text) const {
  act(Tell{kind, task, rtpu, std::move(text)});
}

std::uint64_t Situation::send(Signal signal, std::span<const TaskId> tasks) {
  const std::uint64_t command = mail.post(signal, tasks, now);
  act(Send{roster.rtpu(tasks.front()), command, signal, {tasks.begin(), tasks.end()}});
  return command;
}

std::vector<TaskId> Situation::sorted(std::span<const TaskId> tasks, bool backwards) const {
  std::vector<TaskId> result;
  for (TaskId task : order)
    if (std::find(tasks.begin(), tasks.end(), task) != tasks.end()) result.push_back(task);
  if (backwards) std::reverse(result.begin(), result.end());
  return result;
}

// A process that does not serve us yet may still carry out what an earlier manager sent, or be mute.
bool Situation::may_be_on(TaskId task) const {
  const State seen = roster.status(task).state;
  return seen == State::kOn || mail.is_possible(task, Signal::kOn) ||
         (roster.life_of(task) == Life::kUnknown && (seen == State::kOff || !roster.is_seen(task)));
}

bool Situation::is_busy(TaskId task) const { return mail.is_awaited(task) || roster.status(task).in_service; }

std::string Situation::judge_on(std::span<const TaskId> tasks) const {
  std::vector<bool> on(spec.tasks.size());
  for (std::size_t t = 0; t < on.size(); ++t) on[t] = may_be_on(TaskId(t));
  for (TaskId task : tasks) on[task.index] = true;
  return variables.is_legal(on) ? std::string{} : variables.explain(on, spec.tasks);
}

std::string Situation::illegal(Signal signal, TaskId task, State state, std::span<const TaskId> tasks) const {
  const std::string way = remedy(*this, signal, tasks);
  return name(task) + " is in state " + state_name(state) + ", where " + signal_name(signal) + " is not legal" +
         (way.empty() ? "" : "; type " + way);
}

std::string Situation::missing() const {
  const auto is_on = [this](const PortOf& port) { return roster.state(port.task) == State::kOn; };
  std::string text;
  for (const Variable& variable : variables.all()) {
    const auto writers = std::count_if(variable.producers.begin(), variable.producers.end(), is_on) +
                         (variable.operator_index != UINT32_MAX ? 1 : 0);
    const bool is_read = std::any_of(variable.consumers.begin(), variable.consumers.end(), is_on);
    if (writers == 1 || (writers == 0 && !is_read)) continue;
    std::string who;
    for (const PortOf& port : variable.producers)
      if (writers == 0 || is_on(port))
        who += (who.empty() ? "" : ", ") + name(port.task) + " is " + state_name(roster.state(port.task));
    text += (text.empty() ? "" : "; ") + std::string(variable.name) + (who.empty() ? "" : " (" + who + ")");
  }
  return text;
}

std::string Situation::sentence(const Reply& reply) const {
  if (!reply.is_fault || reply.why.empty()) return reply.why;
  return std::string(signal_name(reply.signal)) + ": " + name(reply.task) + ": " + reply.why;
}

bool is_legal(State state, Signal signal) noexcept {
  return next(state, signal, false).kind != Next::Kind::kImpossible;
}

}  // namespace chimera::subsystem
