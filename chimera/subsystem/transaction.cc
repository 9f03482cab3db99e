// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/transaction.h"

#include <algorithm>

namespace chimera::subsystem {

bool Transaction::has(TaskId task) const noexcept {
  return is_under_way_ && std::any_of(members_.begin(), members_.end(),
                                      [task](const Member& member) { return member.task == task; });
}

Transaction::Member* Transaction::find(TaskId task) noexcept {
  const auto found = std::find_if(members_.begin(), members_.end(),
                                  [task](const Member& member) { return member.task == task; });
  return is_under_way_ && found != members_.end() ? &*found : nullptr;
}

// Goals may find some of their tasks ON already: an earlier manager did not get to the end. Where a person wants a task
// that is ON, there is nothing to do.
TaskId Transaction::first_wrong(const OnWish& wish) const {
  for (TaskId task : wish.tasks) {
    const State state = at_.roster.state(task);
    const bool may_be_on = wish.is_goals || wish.id != 0;
    if (!is_legal(state, Signal::kOn) && !(may_be_on && state == State::kOn)) return task;
  }
  return TaskId{};
}

void Transaction::begin(OnWish wish) {
  const TaskId wrong = first_wrong(wish);
  if (wrong.is_valid())
    return refuse(wish, wrong, at_.illegal(Signal::kOn, wrong, at_.roster.state(wrong), wish.tasks));
  wish_ = std::move(wish);
  members_.clear();
  already_.clear();
  for (TaskId task : at_.sorted(wish_.tasks)) {
    const State before = at_.roster.state(task);
    if (before == State::kOn && !wish_.is_goals) {
      already_.push_back(task);
      continue;
    }
    members_.push_back({task, before, before == State::kOn ? Stage::kOn : Stage::kOpen, false, 0});
  }
  is_under_way_ = true;
  has_failed_ = is_final_ = is_rolling_back_ = false;
  why_.clear();
  std::string why = at_.judge_on(wish_.tasks);
  if (!why.empty()) fail(at_.sorted(wish_.tasks).front(), std::move(why), true);
  for (const Member& member : members_)
    if (!has_failed_) goals_.add(member.task, kGoalOn);
}

bool Transaction::is_waiting() const noexcept {
  return std::any_of(members_.begin(), members_.end(),
                     [](const Member& member) { return member.stage == Stage::kSent; });
}

void Transaction::advance() {
  if (!is_under_way_ || is_waiting()) return;
  if (has_failed_ && !is_rolling_back_) roll_back();
  if (is_waiting()) return;
  const auto open = [](const Member& member) { return member.stage == Stage::kOpen; };
  const auto first = std::find_if(members_.begin(), members_.end(), open);
  if (has_failed_ || first == members_.end()) return finish();
  std::vector<TaskId> run;
  for (auto m = first; m != members_.end() && open(*m); ++m)
    if (at_.roster.rtpu(m->task) == at_.roster.rtpu(first->task)) run.push_back(m->task);
    else break;
  const std::uint64_t command = at_.send(Signal::kOn, run);
  for (auto m = first; m != first + static_cast<std::ptrdiff_t>(run.size()); ++m) {
    m->stage = Stage::kSent;
    m->command = command;
  }
}

void Transaction::take(const Reply& reply) {
  Member* member = find(reply.task);
  if (member == nullptr || member->command != reply.command || member->stage != Stage::kSent) return;
  // After a failed `on` it may be ON for all we know: it is turned OFF with the rest.
  member->stage = is_rolling_back_ || member->is_withdrawn ? Stage::kOver : Stage::kOn;
  if (!is_rolling_back_ && !reply.is_done)
    fail(reply.task, reply.why.empty() ? "" : at_.name(reply.task) + ": " + reply.why, !reply.is_death);
  look(reply.task);
}

void Transaction::look(TaskId task) {
  Member* member = find(task);
  if (member == nullptr || member->stage != Stage::kOn || has_failed_) return;
  const State state = at_.roster.state(task);
  if (state == State::kOn) return;
  fail(task, at_.name(task) + ": went from ON to " + state_name(state), true);
}

void Transaction::withdraw(TaskId task, Signal signal) {
  Member* member = find(task);
  if (member == nullptr) return;
  fail(task, at_.name(task) + ": " + signal_name(signal) + " was asked for meanwhile", !wish_.is_goals);
  member->is_withdrawn = true;
  if (member->stage != Stage::kSent) member->stage = Stage::kOver;
}

void Transaction::lose(RtpuId rtpu, const std::string& cause) {
  for (Member& member : members_) {
    if (!has(member.task) || at_.roster.rtpu(member.task) != rtpu) continue;
    fail(member.task, at_.name(member.task) + ": " + at_.name(rtpu) + " " + cause, !wish_.is_goals);
    member.stage = Stage::kOver;
  }
}

// The first reason counts; a list that failed tells it with one of its tasks and nothing with the others.
void Transaction::fail(TaskId at, std::string why, bool is_final) {
  if (has_failed_ && (!why_.empty() || why.empty())) return;
  has_failed_ = true;
  is_final_ = is_final;
  failed_at_ = at;
  why_ = std::move(why);
}

// One signal each: a list would be refused whole if one of them went OFF by itself.
void Transaction::roll_back() {
  is_rolling_back_ = true;
  for (auto m = members_.rbegin(); m != members_.rend(); ++m) {
    const bool is_there = at_.roster.life_of(m->task) == Life::kUp;
    if (m->stage != Stage::kOn || !is_there || !at_.may_be_on(m->task)) {
      m->stage = Stage::kOver;
      continue;
    }
    m->command = at_.send(Signal::kOff, {&m->task, 1});
    m->stage = Stage::kSent;
  }
}

void Transaction::finish() {
  is_under_way_ = false;
  const bool keeps_goals = has_failed_ && wish_.is_goals && !is_final_;
  if (keeps_goals) return;
  std::vector<Outcome> outcomes;
  for (const Member& member : members_)
    outcomes.push_back({member.task, member.before, at_.roster.state(member.task), false});
  for (const TaskId task : already_) outcomes.push_back({task, State::kOn, State::kOn, true});
  // Before an answer, so that it cannot be undone by the next manager; but goals go with a word about them, not before.
  if (!wish_.is_goals || !has_failed_)
    for (const Member& member : members_) goals_.clear(member.task, kGoalOn);
  if (has_failed_) return refuse(wish_, failed_at_, why_.empty() ? at_.name(failed_at_) + ": on failed" : why_);
  answer(wish_, TaskId{}, {}, std::move(outcomes));
}

void Transaction::refuse(const OnWish& wish, TaskId at, std::string why) {
  if (wish.from.is_valid()) why = "on sent by " + at_.name(wish.from) + ": " + why;
  if (wish.id == 0) at_.tell("refused", at, at_.roster.rtpu(at), std::move(why));
  else answer(wish, at, std::move(why), {});
  if (wish.is_goals)
    for (TaskId task : wish.tasks) goals_.clear(task, kGoalOn);
}

void Transaction::answer(const OnWish& wish, TaskId at, std::string why, std::vector<Outcome> outcomes) const {
  if (wish.id != 0) return at_.act(Answer{wish.id, why.empty(), std::move(why), at, std::move(outcomes)});
  std::string names;
  for (const Outcome& outcome : outcomes) names += (names.empty() ? "" : " ") + at_.name(outcome.task);
  names += outcomes.size() == 1 ? " is ON" : " are ON";
  if (wish.is_goals) return at_.tell("started", TaskId{}, RtpuId{}, names);
  const TaskId task = wish.tasks.front();
  at_.tell("signal", task, at_.roster.rtpu(task), "on sent by " + at_.name(wish.from) + ": " + names);
}

}  // namespace chimera::subsystem
