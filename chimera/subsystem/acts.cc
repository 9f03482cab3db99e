// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/acts.h"

#include <algorithm>

namespace chimera::subsystem {

void Acts::add(const Commanded& command) {
  Act act;
  act.id = command.id;
  act.signal = command.signal;
  act.arrived = at_.now;
  const bool backwards = takes_down(act);
  for (TaskId task : at_.sorted(command.tasks, backwards)) {
    Part part;
    part.task = task;
    part.before = at_.roster.state(task);
    act.parts.push_back(part);
  }
  acts_.push_back(std::move(act));
}

void Acts::advance() {
  if (!at_.is_complete) return;
  for (auto act = acts_.begin(); act != acts_.end();) {
    const bool is_over = (!act->is_begun && try_begin(*act)) || (act->is_begun && try_finish(*act));
    act = is_over ? acts_.erase(act) : std::next(act);
  }
}

// True: over already.
bool Acts::try_begin(Act& act) {
  bool must_wait = false;
  for (Part& part : act.parts) {
    const Verdict verdict = judge(act, part);
    if (verdict == Verdict::kIllegal)
      fail(act, part.task, at_.illegal(act.signal, part.task, state_for(act, part.task), tasks_of(act)));
    if (verdict == Verdict::kNoAnswer) fail(act, part.task, at_.no_answer(part.task));
    must_wait = must_wait || verdict == Verdict::kWait;
  }
  if (!act.has_failed) {
    if (takes_down(act)) take_back(act);
    if (must_wait) return false;
    begin(act);
    return try_finish(act);
  }
  at_.act(Answer{act.id, false, act.why, act.failed_at, {}});
  return true;
}

// While its `on` is under way a task takes `off` after it.
State Acts::state_for(const Act& act, TaskId task) const noexcept {
  const bool turns_on = takes_down(act) && at_.mail.is_awaited(task, Signal::kOn);
  return turns_on && at_.roster.status(task).state == State::kOff ? State::kOn : at_.roster.state(task);
}

bool Acts::is_revival(const Act& act, const Part& part) const noexcept {
  return act.signal == Signal::kSpawn || (act.signal == Signal::kClear && at_.roster.is_lost(part.task));
}

std::vector<TaskId> Acts::tasks_of(const Act& act) {
  std::vector<TaskId> tasks;
  for (const Part& part : act.parts) tasks.push_back(part.task);
  return tasks;
}

// Until when a process that does not serve us is waited for; kNever: there is nothing to wait for.
Nanoseconds Acts::due_for_rtpu(const Act& act, const Part& part) const noexcept {
  const Life life = at_.roster.life_of(part.task);
  if (goals_.is_pursued(part.task)) return kNever;
  if (life == Life::kUnknown) return std::max(act.arrived, at_.complete_since) + kAnswerLimit;
  if (life == Life::kStarting && !is_revival(act, part) && !at_.roster.is_lost(part.task))
    return at_.roster.since(at_.roster.rtpu(part.task)) + kStartLimit;
  return kNever;
}

Acts::Verdict Acts::judge(Act& act, Part& part) const {
  const Nanoseconds due = due_for_rtpu(act, part);
  if (due <= at_.now) return Verdict::kNoAnswer;
  if (due != kNever && !at_.roster.is_seen(part.task)) return Verdict::kWait;
  if (takes_down(act)) return judge_taking_down(act, part, due != kNever);
  if (goals_.is_pursued(part.task) || at_.is_busy(part.task)) {
    part.has_waited = part.has_waited || goals_.has(part.task, kGoalSpawn) || at_.roster.status(part.task).in_service;
    return Verdict::kWait;
  }
  const State state = at_.roster.state(part.task);
  if (act.signal == Signal::kSpawn && part.has_waited && (state == State::kOff || state == State::kOn))
    return Verdict::kGo;  // brought up by a goal meanwhile
  if (act.signal == Signal::kSpawn && at_.roster.is_lost(part.task)) return Verdict::kGo;
  if (!is_legal(state, act.signal)) return Verdict::kIllegal;
  return due == kNever || is_revival(act, part) ? Verdict::kGo : Verdict::kWait;
}

Acts::Verdict Acts::judge_taking_down(const Act& act, const Part& part, bool waits_for_rtpu) const {
  const bool is_spawning = at_.mail.is_awaited(part.task, Signal::kSpawn) || at_.roster.status(part.task).in_service;
  const bool can_be_taken_back = transaction_.has(part.task) || goals_.is_pursued(part.task) ||
                                 (act.signal == Signal::kKill && is_spawning);
  const State state = state_for(act, part.task);
  // The wish is met, unless an `on` that nobody waits for any more may still be carried out.
  const bool is_off =
      act.signal == Signal::kOff && state == State::kOff && !at_.mail.is_possible(part.task, Signal::kOn);
  if (!part.is_taken_back && !can_be_taken_back && !is_off && !is_legal(state, act.signal)) return Verdict::kIllegal;
  if (act.signal == Signal::kKill && is_spawning) return Verdict::kWait;
  const bool is_going_off = part.is_taken_back && at_.mail.is_awaited(part.task, Signal::kOff);
  if (is_going_off && act.signal == Signal::kOff) return Verdict::kWait;
  return waits_for_rtpu && (is_off || is_legal(state, act.signal)) ? Verdict::kWait : Verdict::kGo;
}

void Acts::take_back(Act& act) {
  for (Part& part : act.parts) {
    const bool spawns = at_.mail.is_awaited(part.task, Signal::kSpawn) || at_.roster.status(part.task).in_service;
    if (transaction_.has(part.task) || goals_.is_pursued(part.task) || (act.signal == Signal::kKill && spawns))
      part.is_taken_back = true;
    transaction_.withdraw(part.task, act.signal);
    goals_.clear(part.task, act.signal == Signal::kKill ? kGoalSpawn | kGoalOn : kGoalOn);
  }
}

void Acts::begin(Act& act) {
  act.is_begun = true;
  for (Part& part : act.parts) {
    const State state = state_for(act, part.task);
    if (act.signal == Signal::kKill && at_.roster.is_lost(part.task)) {
      at_.roster.forget(part.task);
      goals_.set(part.task, kGoalGone);
      part.stage = Stage::kOver;
    } else if (!takes_down(act) && is_revival(act, part)) {
      revive(act, part);
    } else if (!is_legal(state, act.signal)) {
      part.stage = Stage::kOver;  // nothing left to do: taken back, or OFF already
      part.is_already = !part.is_taken_back;
    }
    part.after = at_.roster.state(part.task);
  }
  send(act);
}

// With a fresh budget of restarts where somebody had given up.
void Acts::revive(Act& act, Part& part) {
  const State state = at_.roster.state(part.task);
  if (act.signal == Signal::kSpawn && part.has_waited && (state == State::kOff || state == State::kOn)) {
    part.stage = Stage::kOver;
    return;
  }
  part.stage = Stage::kGoal;
  goals_.set(part.task, kGoalSpawn);
  const RtpuId rtpu = at_.roster.rtpu(part.task);
  if (at_.roster.life(rtpu) != Life::kDown) return;
  // One that is cleared brings what was lost with it back, so that `on` of all of them finds them OFF.
  for (const TaskId task : at_.order)
    if (act.signal == Signal::kClear && at_.roster.rtpu(task) == rtpu && at_.roster.is_wanted_back(task))
      goals_.set(task, kGoalSpawn);
  at_.roster.restarts(rtpu) = {};
  at_.act(RememberRestart{rtpu, {}});
  at_.roster.starting(rtpu, at_.now);
  at_.act(StartRtpu{rtpu});
}

void Acts::send(Act& act) {
  std::vector<TaskId> run;
  std::vector<Part*> senders;
  const auto flush = [&] {
    if (run.empty()) return;
    const std::uint64_t command = at_.send(act.signal, run);
    for (Part* part : senders) part->command = command;
    run.clear();
    senders.clear();
  };
  for (Part& part : act.parts) {
    if (part.stage != Stage::kOpen) continue;
    if (!run.empty() && at_.roster.rtpu(run.back()) != at_.roster.rtpu(part.task)) flush();
    run.push_back(part.task);
    senders.push_back(&part);
    part.stage = Stage::kSent;
  }
  flush();
}

void Acts::take(const Reply& reply) {
  for (Act& act : acts_)
    for (Part& part : act.parts) {
      if (part.stage != Stage::kSent || part.task != reply.task || part.command != reply.command) continue;
      part.stage = Stage::kOver;
      part.before = reply.before;
      part.after = reply.after;
      if (!reply.is_done) fail(act, part.task, at_.sentence(reply));
      return;
    }
}

void Acts::lose(RtpuId rtpu, const std::string& cause) {
  for (Act& act : acts_)
    for (Part& part : act.parts) {
      if (part.stage != Stage::kGoal || at_.roster.rtpu(part.task) != rtpu) continue;
      goals_.clear(part.task, kGoalSpawn | kGoalOn);  // an init that kills its process is not tried again
      part.stage = Stage::kOver;
      fail(act, part.task, at_.name(rtpu) + " " + cause);
    }
}

void Acts::look_at_goals(Act& act) {
  for (Part& part : act.parts) {
    if (part.stage != Stage::kGoal || goals_.has(part.task, kGoalSpawn)) continue;
    part.stage = Stage::kOver;
    part.after = at_.roster.state(part.task);
    const std::string& why = goals_.failure(part.task);
    if (!why.empty()) fail(act, part.task, why);
  }
}

// A list that was refused whole tells the reason with one of its tasks.
void Acts::fail(Act& act, TaskId task, std::string why) {
  if (act.has_failed && (!act.why.empty() || why.empty())) return;
  act.has_failed = true;
  act.failed_at = task;
  act.why = std::move(why);
}

bool Acts::try_finish(Act& act) {
  look_at_goals(act);
  for (const Part& part : act.parts)
    if (part.stage != Stage::kOver) return false;
  Answer answer{act.id, !act.has_failed, act.why, act.failed_at, {}};
  if (act.has_failed && act.why.empty())
    answer.text = at_.name(act.failed_at) + ": " + signal_name(act.signal) + " failed";
  for (const Part& part : act.parts) answer.outcomes.push_back({part.task, part.before, part.after, part.is_already});
  at_.act(std::move(answer));
  return true;
}

Nanoseconds Acts::next_due() const noexcept {
  Nanoseconds next = kNever;
  if (!at_.is_complete) return next;
  for (const Act& act : acts_)
    for (const Part& part : act.parts)
      if (!act.is_begun) next = std::min(next, due_for_rtpu(act, part));
  return next;
}

}  // namespace chimera::subsystem
