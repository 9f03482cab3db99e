// SPDX-License-Identifier: Apache-2.0
// One transaction from its judgement to the answer, over its roll-back if it fails.
#include "chimera/subsystem/on_transaction.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"

namespace chimera::subsystem {

bool OnTransaction::has(TaskId task) const noexcept {
  return is_under_way_ && std::any_of(members_.begin(), members_.end(),
                                      [task](const Member& member) { return member.task == task; });
}

OnTransaction::Member* OnTransaction::find(TaskId task) noexcept {
  const auto found = std::find_if(members_.begin(), members_.end(),
                                  [task](const Member& member) { return member.task == task; });
  return is_under_way_ && found != members_.end() ? &*found : nullptr;
}

// First task of the request that may not go ON. Goals may find some tasks ON, if an earlier manager did not finish. A
// person's `on` of a task that is ON has no work to do.
TaskId OnTransaction::first_wrong(const OnRequest& request) const {
  for (TaskId task : request.tasks) {
    const State state = state_.observed.state(task);
    const bool may_be_on = request.is_goals || request.id != 0;
    if (!is_legal(state, Signal::kOn) && !(may_be_on && state == State::kOn)) return task;
  }
  return TaskId{};
}

void OnTransaction::begin(OnRequest request) {
  const TaskId wrong = first_wrong(request);
  if (wrong.is_valid())
    return refuse(request, wrong, state_.illegal(Signal::kOn, wrong, state_.observed.state(wrong), request.tasks));
  request_ = std::move(request);
  members_.clear();
  already_.clear();
  for (TaskId task : state_.sorted(request_.tasks)) {
    const State before = state_.observed.state(task);
    if (before == State::kOn && !request_.is_goals) {
      already_.push_back(task);
      continue;
    }
    members_.push_back({task, before, before == State::kOn ? Stage::kOn : Stage::kOpen, false, false, 0});
  }
  is_under_way_ = true;
  until_ = state_.now + kReadyLimit;
  again_at_ = kNever;
  is_final_ = is_rolling_back_ = false;
  refusal_ = {};
  if (SignalRefusal why = state_.judge_on(request_.tasks); why.is_refused())
    return fail(state_.sorted(request_.tasks).front(), std::move(why), true);
  for (const Member& member : members_) goals_.add(member.task, kGoalOn);
}

bool OnTransaction::is_waiting() const noexcept {
  return std::any_of(members_.begin(), members_.end(),
                     [](const Member& member) { return member.stage == Stage::kSent; });
}

bool OnTransaction::advance() {
  if (!is_under_way_ || is_waiting()) return false;
  if (again_at_ != kNever && state_.now < again_at_ && !refusal_.is_refused()) return false;
  again_at_ = kNever;
  if (!refusal_.is_refused()) send_next();
  else if (!is_rolling_back_) roll_back();
  if (!is_waiting()) finish();
  return true;
}

// Sends the open members up to the first one of another rtpu. An rtpu judges and carries out one list as one step.
void OnTransaction::send_next() {
  const auto is_open = [](const Member& member) { return member.stage == Stage::kOpen; };
  const auto first = std::find_if(members_.begin(), members_.end(), is_open);
  if (first == members_.end()) return;
  const RtpuId rtpu = state_.observed.rtpu(first->task);
  const auto end = std::find_if(first, members_.end(), [&](const Member& member) {
    return !is_open(member) || state_.observed.rtpu(member.task) != rtpu;
  });
  std::vector<TaskId> tasks;
  for (auto member = first; member != end; ++member) tasks.push_back(member->task);
  const std::uint64_t command = state_.send(Signal::kOn, tasks);
  for (auto member = first; member != end; ++member) {
    member->stage = Stage::kSent;
    member->command = command;
  }
}

void OnTransaction::on_result(const SignalResult& result) {
  Member* member = find(result.task);
  if (member == nullptr || member->command != result.command || member->stage != Stage::kSent) return;
  if (is_asked_again(result)) {
    member->stage = Stage::kOpen;
    return;
  }
  // A task whose `on` failed may still be ON: it is turned OFF with the rest.
  member->stage = is_rolling_back_ || member->is_withdrawn ? Stage::kOver : Stage::kOn;
  if (!is_rolling_back_ && !result.is_done())
    fail(result.task, result.refusal.behind(state_.name(result.task) + ": "),
         result.refusal.kind != RefusalKind::kEnded);
  on_task_seen(result.task);
}

// Asks again for `on` of a task that is not ready, and of the tasks behind it in the list: the rtpu did not ask those.
bool OnTransaction::is_asked_again(const SignalResult& result) {
  Member* const member = find(result.task);
  const bool is_not_ready = result.refusal.kind == RefusalKind::kNotYet;
  const bool is_behind = result.refusal.kind == RefusalKind::kOther && result.command == not_ready_;
  member->is_half_on = is_not_ready;
  if (is_rolling_back_ || refusal_.is_refused() || member->is_withdrawn || state_.now >= until_) return false;
  if (!is_not_ready && !is_behind) return false;
  if (is_not_ready) {
    not_ready_ = result.command;
    again_at_ = state_.now + std::max(state_.spec.tasks[result.task.index].period, milliseconds(1));
  }
  return true;
}

void OnTransaction::on_task_seen(TaskId task) {
  const Member* member = find(task);
  if (member == nullptr || member->stage != Stage::kOn || refusal_.is_refused()) return;
  const State state = state_.observed.state(task);
  if (state == State::kOn) return;
  fail(task, {RefusalKind::kFault, state_.name(task) + ": went from ON to " + state_name(state), {}}, true);
}

bool OnTransaction::withdraw(TaskId task, Signal signal) {
  Member* member = find(task);
  if (member == nullptr || member->is_withdrawn) return false;
  const std::string why = state_.name(task) + ": " + signal_name(signal) + " was asked for in between";
  fail(task, {RefusalKind::kOvertaken, why, {}}, !request_.is_goals);
  member->is_withdrawn = true;
  if (member->stage != Stage::kSent && !member->is_half_on) member->stage = Stage::kOver;
  return true;
}

void OnTransaction::on_rtpu_down(RtpuId rtpu, const std::string& cause) {
  for (Member& member : members_) {
    if (!has(member.task) || state_.observed.rtpu(member.task) != rtpu) continue;
    fail(member.task, state_.ended(rtpu, cause).behind(state_.name(member.task) + ": "), !request_.is_goals);
    member.stage = Stage::kOver;
  }
}

// Keeps the first reason. A list that failed gives its reason with one of its tasks and no reason with the others.
void OnTransaction::fail(TaskId task, SignalRefusal why, bool is_final) {
  if (!refusal_.add(std::move(why))) return;
  is_final_ = is_final;
  failed_at_ = task;
}

// Sends one `off` for each task: the rtpu would refuse a whole list if one of the tasks went OFF by itself.
void OnTransaction::roll_back() {
  is_rolling_back_ = true;
  for (auto m = members_.rbegin(); m != members_.rend(); ++m) {
    const bool is_there = state_.observed.life_of(m->task) == RtpuLife::kUp;
    const bool is_on = m->stage == Stage::kOn && state_.may_be_on(m->task);
    if (m->stage == Stage::kOver || !is_there || !(is_on || m->is_half_on)) {
      m->stage = Stage::kOver;
      continue;
    }
    m->command = state_.send(Signal::kOff, {&m->task, 1});
    m->stage = Stage::kSent;
  }
}

// Takes goals back before it answers, so that the next manager cannot undo the answer. For a request of goals it logs
// the failure first: the next manager can log it again.
void OnTransaction::finish() {
  is_under_way_ = false;
  if (!refusal_.is_refused()) {
    std::vector<TaskOutcome> outcomes;
    for (const Member& member : members_)
      outcomes.push_back({member.task, member.before, state_.observed.state(member.task), false});
    for (const TaskId task : already_) outcomes.push_back({task, State::kOn, State::kOn, true});
    for (const Member& member : members_) goals_.clear(member.task, kGoalOn);
    return report_done(std::move(outcomes));
  }
  if (request_.is_goals && !is_final_) return;  // the goals stay and are tried again
  if (!request_.is_goals)
    for (const Member& member : members_) goals_.clear(member.task, kGoalOn);
  if (refusal_.reason.empty()) refusal_.reason = state_.name(failed_at_) + ": on failed";
  refuse(request_, failed_at_, refusal_);
}

void OnTransaction::refuse(const OnRequest& request, TaskId task, const SignalRefusal& why) {
  const bool is_sent = request.from.is_valid();
  const SignalRefusal named = is_sent ? why.behind("on sent by " + state_.name(request.from) + ": ") : why;
  if (request.id == 0) state_.log("refused", task, state_.observed.rtpu(task), named.text());
  else state_.emit(CommandAnswer{request.id, named, task, {}});
  if (request.is_goals)
    for (TaskId one : request.tasks) goals_.clear(one, kGoalOn);
}

void OnTransaction::report_done(std::vector<TaskOutcome> outcomes) const {
  if (request_.id != 0) return state_.emit(CommandAnswer{request_.id, {}, TaskId{}, std::move(outcomes)});
  const auto name = [this](const TaskOutcome& outcome) { return state_.name(outcome.task); };
  const std::string names = join(outcomes, " ", name) + (outcomes.size() == 1 ? " is ON" : " are ON");
  if (request_.is_goals) return state_.log("started", TaskId{}, RtpuId{}, names);
  const TaskId task = request_.tasks.front();
  state_.log("signal", task, state_.observed.rtpu(task), "on sent by " + state_.name(request_.from) + ": " + names);
}

}  // namespace chimera::subsystem
