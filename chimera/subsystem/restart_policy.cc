// SPDX-License-Identifier: Apache-2.0
// Restarts dead rtpus within their budget. The order of its notes lets the next manager continue from any point.
#include "chimera/subsystem/restart_policy.h"

#include <algorithm>

#include "chimera/subsystem/remedy.h"

namespace chimera::subsystem {

RestartPolicy::RestartPolicy(SubsystemState& state, Goals& goals, OnTransaction& transaction, CommandQueue& commands)
    : state_(state),
      goals_(goals),
      transaction_(transaction),
      commands_(commands),
      handled_(state.spec.rtpus.size()),
      was_on_(state.spec.tasks.size()) {}

void RestartPolicy::recall(const Begun& begun) {
  for (std::size_t r = 0; r < handled_.size(); ++r) {
    if (r < begun.handled.size()) handled_[r] = begun.handled[r];
    if (r < begun.restarts.size()) state_.observed.restarts(RtpuId(r)) = begun.restarts[r];
  }
}

// Remembers goals first, then the restart, then that the death was handled. A manager may die between two of these
// steps: the next manager then reaches an equal result. Only the last step can say "given up".
bool RestartPolicy::on_rtpu_down(const RtpuDown& down) {
  const RtpuLife life = state_.observed.life(down.rtpu);
  const bool is_old = life == RtpuLife::kDown || life == RtpuLife::kStarting;
  if (is_old && down.incarnation <= state_.observed.incarnation(down.rtpu)) return false;
  commands_.on_rtpu_down(down.rtpu, down.cause);
  transaction_.on_rtpu_down(down.rtpu, down.cause);
  std::vector<std::uint32_t> goals(state_.spec.tasks.size());
  for (std::size_t t = 0; t < goals.size(); ++t)
    if (is_of(TaskId(t), down.rtpu)) was_on_[t] = ((goals[t] = goal_after(TaskId(t))) & kGoalOn) != 0;
  state_.observed.down(down.rtpu, down.incarnation);
  const bool is_known =
      down.incarnation <= handled_[down.rtpu.index];  // an earlier manager handled this death and set the goals
  for (std::size_t t = 0; t < goals.size(); ++t)
    if (is_of(TaskId(t), down.rtpu)) state_.observed.want_back(TaskId(t), goals[t] != 0 && !is_known);
  if (is_known) {
    for (TaskId task : goals_.with(kGoalGone)) state_.observed.forget(task);
    start_for_goals(down.rtpu);
    return true;
  }
  state_.log("rtpu-ended", TaskId{}, down.rtpu, state_.name(down.rtpu) + " " + down.cause);
  if (down.is_end) return true;  // the keeper starts no process any more, and no next manager needs a note
  if (recent(down.rtpu) < kRestartIntensity) restart(down, goals);
  else give_up(down);
  return true;
}

// Goal of the task after its process died: its last state, but a person's last command counts more. A transaction that
// fails by this death takes its own goals back.
std::uint32_t RestartPolicy::goal_after(TaskId task) const {
  const State last = state_.observed.status(task).state;
  if (state_.pending.is_possible(task, Signal::kKill)) return 0;
  if (last == State::kNotCreated && !goals_.has(task, kGoalSpawn)) return 0;
  const bool was_on = last == State::kOn && !state_.pending.is_possible(task, Signal::kOff);
  return was_on || goals_.has(task, kGoalOn) ? kGoalSpawn | kGoalOn : kGoalSpawn;
}

int RestartPolicy::recent(RtpuId rtpu) const noexcept {
  const auto& instants = state_.observed.restarts(rtpu);
  return static_cast<int>(std::count_if(instants.begin(), instants.end(), [this](Nanoseconds instant) {
    return instant.count != 0 && instant + kRestartWindow > state_.now;
  }));
}

void RestartPolicy::restart(const RtpuDown& down, const std::vector<std::uint32_t>& goals) {
  for (std::size_t t = 0; t < goals.size(); ++t)
    if (is_of(TaskId(t), down.rtpu)) goals_.set(TaskId(t), goals[t]);
  for (std::size_t t = 0; t < goals.size(); ++t)
    if ((goals[t] & kGoalOn) != 0) leave_off_for(TaskId(t));
  auto& instants = state_.observed.restarts(down.rtpu);
  *std::min_element(instants.begin(), instants.end()) = state_.now;
  state_.emit(RememberRestart{down.rtpu, instants});
  state_.observed.starting(down.rtpu, state_.now);
  state_.emit(StartRtpu{down.rtpu});
  handled_[down.rtpu.index] = down.incarnation;
  state_.emit(RememberHandled{down.rtpu, down.incarnation});
  state_.log("rtpu-restarted", TaskId{}, down.rtpu,
           state_.name(down.rtpu) + " is restarted, " + std::to_string(recent(down.rtpu)) + " of at most " +
               std::to_string(kRestartIntensity) + " times in " +
               std::to_string(kRestartWindow / seconds(1)) + " s");
}

// Clears the goals of the tasks that `task` replaces: its process died last, so it had taken over. They must not come
// back ON beside it.
void RestartPolicy::leave_off_for(TaskId task) {
  for (std::size_t t = 0; t < state_.spec.tasks.size(); ++t)
    if (state_.spec.stand_in(task, TaskId(t)))
      goals_.clear(TaskId(t), state_.rivals.are(task, TaskId(t)) ? kGoalSpawn | kGoalOn : kGoalOn);
}

void RestartPolicy::give_up(const RtpuDown& down) {
  const SignalRefusal why = {RefusalKind::kEnded,
                             state_.name(down.rtpu) + " ended " + std::to_string(kRestartIntensity + 1) + " times in " +
                                 std::to_string(kRestartWindow / seconds(1)) + " s and is not restarted: it " +
                                 down.cause,
                             typed(way_back(down.rtpu))};
  for (TaskId task : state_.spec.on_order)
    if (is_of(task, down.rtpu) && goals_.is_pursued(task)) goals_.fail(task, why);
  state_.log("rtpu-given-up", TaskId{}, down.rtpu, why.text());
  for (TaskId task : state_.spec.on_order)
    if (is_of(task, down.rtpu) && was_on_[task.index] && !down.is_orderly)
      state_.log("not-off", task, down.rtpu,
               state_.name(down.rtpu) + " " + down.cause + ", is not restarted, and this task was not turned off: its "
               "hardware may not be off");
  handled_[down.rtpu.index] = down.incarnation;
  state_.emit(RememberHandled{down.rtpu, down.incarnation});
}

std::string RestartPolicy::way_back(RtpuId rtpu) const {
  std::vector<TaskId> lost, absent, were_on;
  for (const TaskId task : state_.spec.on_order) {
    if (!is_of(task, rtpu)) continue;
    const bool is_lost = state_.observed.is_lost(task);
    (is_lost ? lost : absent).push_back(task);
    if (is_lost && was_on_[task.index]) were_on.push_back(task);
  }
  // A manager that started after the rtpu was given up does not know the lost tasks.
  return lost.empty() ? spawning(state_, absent) : subsystem::way_back(state_, lost, were_on);
}

void RestartPolicy::start_for_goals(RtpuId rtpu) {
  const auto wanted = goals_.with(kGoalSpawn | kGoalOn);
  if (std::none_of(wanted.begin(), wanted.end(), [&](TaskId task) { return is_of(task, rtpu); })) return;
  state_.observed.starting(rtpu, state_.now);
  state_.emit(StartRtpu{rtpu});
}

}  // namespace chimera::subsystem
