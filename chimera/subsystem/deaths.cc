// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/deaths.h"

#include <algorithm>

#include "chimera/subsystem/remedy.h"

namespace chimera::subsystem {

Deaths::Deaths(Situation& situation, Goals& goals, Transaction& transaction, Acts& acts)
    : at_(situation),
      goals_(goals),
      transaction_(transaction),
      acts_(acts),
      handled_(situation.spec.rtpus.size()),
      was_on_(situation.spec.tasks.size()) {}

void Deaths::recall(const Begun& begun) {
  for (std::size_t r = 0; r < handled_.size(); ++r) {
    if (r < begun.handled.size()) handled_[r] = begun.handled[r];
    if (r < begun.restarts.size()) at_.roster.restarts(RtpuId(r)) = begun.restarts[r];
  }
}

// What is remembered comes in an order in which every beginning of it leads the next manager to the same end: goals
// first, then the start, then that the death was dealt with: that alone says given up.
bool Deaths::take(const RtpuDown& down) {
  const Life life = at_.roster.life(down.rtpu);
  const bool is_old = life == Life::kDown || life == Life::kStarting;
  if (is_old && down.incarnation <= at_.roster.incarnation(down.rtpu)) return false;
  acts_.lose(down.rtpu, down.cause);
  transaction_.lose(down.rtpu, down.cause);
  std::vector<std::uint32_t> goals(at_.spec.tasks.size());
  for (std::size_t t = 0; t < goals.size(); ++t)
    if (is_of(TaskId(t), down.rtpu)) was_on_[t] = ((goals[t] = goal_after(TaskId(t))) & kGoalOn) != 0;
  at_.roster.down(down.rtpu, down.incarnation);
  const bool is_known =
      down.incarnation <= handled_[down.rtpu.index];  // to an earlier manager, and what was asked of it
  for (std::size_t t = 0; t < goals.size(); ++t)
    if (is_of(TaskId(t), down.rtpu)) at_.roster.want_back(TaskId(t), goals[t] != 0 && !is_known);
  if (is_known) {
    for (TaskId task : goals_.with(kGoalGone)) at_.roster.forget(task);
    start_for_goals(down.rtpu);
    return true;
  }
  at_.tell("rtpu-ended", TaskId{}, down.rtpu, at_.name(down.rtpu) + " " + down.cause);
  if (down.is_end) return true;  // the keeper starts nobody any more, and no manager comes to wonder why
  if (recent(down.rtpu) < kRestartIntensity) restart(down, goals);
  else give_up(down);
  return true;
}

// As it was at the end, but a person's last word counts more than a state on the way to it. A transaction that fails by
// this death takes its goals back itself.
std::uint32_t Deaths::goal_after(TaskId task) const {
  const State last = at_.roster.status(task).state;
  if (at_.mail.is_possible(task, Signal::kKill)) return 0;
  if (last == State::kNotCreated && !goals_.has(task, kGoalSpawn)) return 0;
  const bool was_on = last == State::kOn && !at_.mail.is_possible(task, Signal::kOff);
  return was_on || goals_.has(task, kGoalOn) ? kGoalSpawn | kGoalOn : kGoalSpawn;
}

int Deaths::recent(RtpuId rtpu) const noexcept {
  const auto& instants = at_.roster.restarts(rtpu);
  return static_cast<int>(std::count_if(instants.begin(), instants.end(), [this](Nanoseconds instant) {
    return instant.count != 0 && instant + kRestartWindow > at_.now;
  }));
}

void Deaths::restart(const RtpuDown& down, const std::vector<std::uint32_t>& goals) {
  for (std::size_t t = 0; t < goals.size(); ++t)
    if (is_of(TaskId(t), down.rtpu)) goals_.set(TaskId(t), goals[t]);
  auto& instants = at_.roster.restarts(down.rtpu);
  *std::min_element(instants.begin(), instants.end()) = at_.now;
  at_.act(RememberRestart{down.rtpu, instants});
  at_.roster.starting(down.rtpu, at_.now);
  at_.act(StartRtpu{down.rtpu});
  handled_[down.rtpu.index] = down.incarnation;
  at_.act(RememberHandled{down.rtpu, down.incarnation});
  at_.tell("rtpu-restarted", TaskId{}, down.rtpu,
           at_.name(down.rtpu) + " is restarted, " + std::to_string(recent(down.rtpu)) + " of at most " +
               std::to_string(kRestartIntensity) + " times in " +
               std::to_string(kRestartWindow / seconds(1)) + " s");
}

void Deaths::give_up(const RtpuDown& down) {
  const std::string why = at_.name(down.rtpu) + " ended " + std::to_string(kRestartIntensity + 1) + " times in " +
                          std::to_string(kRestartWindow / seconds(1)) + " s and is not restarted: it " + down.cause +
                          (way_back(down.rtpu).empty() ? "" : "; type " + way_back(down.rtpu));
  for (TaskId task : at_.order)
    if (is_of(task, down.rtpu) && goals_.is_pursued(task)) goals_.fail(task, "refused", why);
  at_.tell("rtpu-given-up", TaskId{}, down.rtpu, why);
  for (TaskId task : at_.order)
    if (is_of(task, down.rtpu) && was_on_[task.index] && !down.is_orderly)
      at_.tell("not-off", task, down.rtpu,
               at_.name(down.rtpu) + " " + down.cause + ", is not restarted, and this task was not turned off: its "
               "hardware may not be off");
  handled_[down.rtpu.index] = down.incarnation;
  at_.act(RememberHandled{down.rtpu, down.incarnation});
}

std::string Deaths::way_back(RtpuId rtpu) const {
  std::vector<TaskId> lost, were_on;
  for (const TaskId task : at_.order) {
    if (!is_of(task, rtpu) || !at_.roster.is_lost(task)) continue;
    lost.push_back(task);
    if (was_on_[task.index]) were_on.push_back(task);
  }
  return subsystem::way_back(at_, lost, were_on);
}

void Deaths::start_for_goals(RtpuId rtpu) {
  const auto wanted = goals_.with(kGoalSpawn | kGoalOn);
  if (std::none_of(wanted.begin(), wanted.end(), [&](TaskId task) { return is_of(task, rtpu); })) return;
  at_.roster.starting(rtpu, at_.now);
  at_.act(StartRtpu{rtpu});
}

}  // namespace chimera::subsystem
