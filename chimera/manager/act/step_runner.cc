// SPDX-License-Identifier: Apache-2.0
// Carries out the actions of the step function, each by its kind.
#include "chimera/manager/act/step_runner.h"

#include "chimera/manager/state/command_text.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

void StepRunner::begin() {
  subsystem::Begun begun;
  for (std::uint32_t t = 0; t < state_.peers.n_tasks(); ++t)
    begun.goals.push_back(state_.own.block().view().goal(TaskId(t)));
  for (std::uint32_t r = 0; r < state_.peers.n_rtpus(); ++r) {
    begun.handled.push_back(memory().handled[r]);
    auto& instants = begun.restarts.emplace_back();
    for (std::size_t i = 0; i < instants.size(); ++i) instants[i] = {memory().restarts[r][i]};
  }
  begun.started = memory().started != 0;
  step(begun);
}

void StepRunner::step(const subsystem::Event& event) {
  std::vector<subsystem::Action> actions;
  state_.logic.step(event, now(), actions);
  for (const subsystem::Action& action : actions) std::visit([this](const auto& one) { carry_out(one); }, action);
}

void StepRunner::command(Signal signal, std::vector<TaskId> tasks, Answered answered) {
  const std::uint64_t id = ++last_command_;
  waiting_[id] = [this, words = command_text(state_.spec(), signal, tasks),
                  answered = std::move(answered), by = state_.acting](const subsystem::CommandAnswer& answer) {
    const Acting acting(state_, by);
    const bool is_done = answer.is_accepted();
    state_.tell("command", is_done ? TaskId{} : answer.at, RtpuId{},
                words + (is_done ? ": done" : ": refused: " + answer.refusal.text()), now());
    answered(answer);
  };
  step(subsystem::Commanded{id, signal, std::move(tasks)});
}

// A signal without room gets no report, so the step function fails it after its time limit.
void StepRunner::carry_out(const subsystem::Send& send) { (void)links_.send(send, now()); }

void StepRunner::carry_out(const subsystem::StartRtpu& start) {
  KeeperMessage message;
  message.kind = KeeperMessage::Kind::kStart;
  message.index = start.rtpu.index;
  (void)keeper_.send(bytes_of(message));  // not sent: the keeper is gone
}

void StepRunner::carry_out(const subsystem::RememberGoal& goal) { state_.own.block().set_goal(goal.task, goal.goal); }

void StepRunner::carry_out(const subsystem::RememberHandled& handled) {
  memory().handled[handled.rtpu.index] = handled.incarnation;
  for (std::uint32_t t = 0; t < state_.peers.n_tasks(); ++t)  // the goals hold the last states now
    if (state_.spec().tasks[t].rtpu == handled.rtpu) state_.own.block().set_status(TaskId(t), {});
}

void StepRunner::carry_out(const subsystem::RememberRestart& restart) {
  for (std::size_t i = 0; i < restart.instants.size(); ++i)
    memory().restarts[restart.rtpu.index][i] = restart.instants[i].count;
}

void StepRunner::carry_out(const subsystem::RememberStarted&) { memory().started = 1; }

void StepRunner::carry_out(const subsystem::CommandAnswer& answer) {
  if (auto found = waiting_.extract(answer.id); !found.empty()) found.mapped()(answer);
}

void StepRunner::carry_out(const subsystem::LogEvent& event) {
  if (event.kind == "started" && memory().started_at == 0) memory().started_at = now().count;
  state_.tell(event.kind, event.task, event.rtpu, event.text, now());
}

}  // namespace chimera::manager
