// SPDX-License-Identifier: Apache-2.0
// Orders a switch from the rtpus and makes one receipt from their parts.
#include "chimera/manager/switch/switch_coordinator.h"

#include <algorithm>
#include <ctime>
#include <utility>

#include "chimera/control/receipt/receipt_json.h"
#include "chimera/control/receipt/receipt_text.h"
#include "chimera/control/receipt/switch_reason.h"
#include "chimera/manager/answer/status_json.h"

namespace chimera::manager {
namespace {

constexpr Nanoseconds kGrace = milliseconds(500);  // time in which the rtpus abort by themselves
// Time for one step after the deadline: a device has as long on the way back.
constexpr Nanoseconds kStepPatience = kReadyLimit + kGrace;

/// "14:03:07", of the wall clock.
std::string time_of_day(Nanoseconds at) {
  const auto seconds_since = static_cast<std::time_t>(wall_ns(at) / 1'000'000'000);
  std::tm broken_down{};
  char text[16] = "?";
  if (::localtime_r(&seconds_since, &broken_down) != nullptr) std::strftime(text, sizeof text, "%T", &broken_down);
  return text;
}

/// False for a cause that no manager would write: the predecessor may have damaged its journal.
bool is_cause(const BegunSwitch& begun, const ApplicationSpec& spec) {
  const bool is_of_task = begun.cause > SwitchCause::kScript && begun.cause <= SwitchCause::kFault;
  return is_of_task ? begun.by.index < spec.tasks.size() : begun.cause == SwitchCause::kScript && !begun.by.is_valid();
}

bool is_way(const SwitchWay& way, const ApplicationSpec& spec) {
  const auto is_task = [&](TaskId task) { return !task.is_valid() || task.index < spec.tasks.size(); };
  const ConstantUsers::Found& found = way.constant;
  return way.slow <= kSlowReasons && is_task(found.task) && is_task(way.deadline.task) && is_task(way.gapless) &&
         is_task(way.absent) && is_task(way.rival) &&
         (!found.task.is_valid() || found.constant.index < spec.constants.size());
}

/// Upper bound of the gaps of the rtpu while the tasks `on` cycle: the longest time between two releases of the tasks
/// with the shortest period.
Nanoseconds longest_gap(const ApplicationSpec& spec, const TaskBits& on, RtpuId rtpu) {
  std::vector<const TaskSpec*> fastest;
  for (std::size_t t = 0; t < spec.tasks.size(); ++t) {
    const TaskSpec& task = spec.tasks[t];
    if (!on.has(TaskId(t)) || task.rtpu != rtpu || task.aperiodic) continue;
    if (!fastest.empty() && task.period < fastest[0]->period) fastest.clear();
    if (fastest.empty() || task.period == fastest[0]->period) fastest.push_back(&task);
  }
  if (fastest.empty()) return kNever;
  const std::int64_t period = fastest[0]->period.count;
  std::int64_t longest = 0;
  for (const TaskSpec* each : fastest) {
    std::int64_t next = period;
    for (const TaskSpec* other : fastest) {
      const std::int64_t behind = ((other->offset - each->offset).count % period + period) % period;
      if (behind > 0) next = std::min(next, behind);
    }
    longest = std::max(longest, next);
  }
  return Nanoseconds{longest};
}

std::string asker_text(const BegunSwitch& begun, const ApplicationSpec& spec) {
  if (begun.cause == SwitchCause::kScript) return begun.asked_by.text();
  return control::asked_by({begun.order.after, begun.cause, begun.by}, spec);
}

/// Typical time of the method; for a method that was never called, the guess of IdleGap.
Nanoseconds method_time(const ManagerState& state, TaskId task, Method method) {
  const Nanoseconds budget = state.spec().tasks[task.index].budget;
  const Nanoseconds guess = budget > Nanoseconds{} ? budget : IdleGap::kUnknownMethod;
  const Profile profile = state.profile(task);
  return profile.execution[static_cast<int>(method)].count == 0 ? guess : profile.of_late(method);
}

}  // namespace

// True if one of the tasks in `tasks` shares a resource with `task`.
static bool has_rival_in(const ManagerState& state, TaskId task, const TaskBits& tasks) {
  for (std::size_t t = 0; t < state.spec().tasks.size(); ++t)
    if (tasks.has(TaskId(t)) && state.rivals.are(task, TaskId(t))) return true;
  return false;
}

TaskStatus last_status(const ManagerState& state, TaskId task) {
  TaskStatus status = state.peers.status(task);
  SwitchAgreement agreement(state.page.switching, state.keeper.origin);
  const PlanWord plan = agreement.plan();
  const RtpuId rtpu = state.spec().tasks[task.index].rtpu;
  const auto order = agreement.order(plan, state.spec().sets.size(), state.spec().tasks.size());
  const bool was_member = order && ((order->members >> rtpu.index) & 1u) != 0;
  if (!was_member || !state.peers[rtpu].is_there()) return status;
  const SwitchProgress& progress = state.peers[rtpu].block().head().switching;
  if (progress.adopted.load(std::memory_order_acquire) == plan.number) return status;  // SwitchProgress
  if (plan.phase != SwitchPhase::kCommitted) {  // it may have carried out a part of a slow one
    if (order->slow != 0 && status.state <= State::kOn)
      status.state = order->on.has(task) ? State::kOn : std::min(status.state, State::kOff);
    if (order->slow != 0 && has_rival_in(state, task, order->on)) status.state = State::kNotCreated;
    return status;
  }
  const bool is_after = order->target.has(task);
  if (is_after && status.state == State::kOff) status.state = State::kOn;
  if (!is_after && status.state == State::kOn) status.state = State::kOff;
  return status;
}

void abort_open_plan_of(ManagerState& state, RtpuId rtpu) {
  SwitchAgreement agreement(state.page.switching, state.keeper.origin);
  const PlanWord plan = agreement.plan();
  if (!plan.is_open()) return;
  const auto order = agreement.order(plan, state.spec().sets.size(), state.spec().tasks.size());
  const bool is_member = order && ((order->members >> rtpu.index) & 1u) != 0;
  if (is_member && agreement.abort(plan.number)) state.announce();
}

SwitchCoordinator::SwitchCoordinator(ManagerState& state, ReceiptArchive& archive)
    : state_(state),
      archive_(archive),
      journal_(state.own.block().journal()),
      members_(state),
      orders_(members_) {
  orders_.prepare(state.spec(), false, memory_);
  orders_.begin(state.keeper.origin);
  slow_.prepare(state.spec(), memory_);
  take_over();
}

/// Forgets a switch that was never announced. If only its last try was not announced, continues with the tries before.
void SwitchCoordinator::take_over() {
  const PlanWord plan = agreement().plan();
  const std::size_t n_sets = state_.spec().sets.size();
  last_ = agreement().order(plan, n_sets, state_.spec().tasks.size());
  last_plan_ = plan;
  auto begun = journal_.begun();
  if (!begun) return;
  const bool is_damaged = begun->order.after != set_of(state_.spec(), begun->order.target) ||
                          (begun->before >= n_sets && begun->before != kNoSet) ||
                          begun->asked_by.role > control::Role::kConfigure ||
                          begun->cancelled_by.role > control::Role::kConfigure || !is_cause(*begun, state_.spec()) ||
                          !is_way(begun->way, state_.spec());
  // A number that is neither its own nor the one before was written by something else: see look().
  const bool is_announced = next_plan(plan.number) != begun->order.number;
  if (is_damaged || (!is_announced && begun->tries <= 1)) return journal_.forget();
  if (!is_announced) {
    begun->order.number = plan.number;
    --begun->tries;
  }
  present_ = Present{*begun, {}};
  last_ = begun->order;
  if (plan.number != last_->number) last_plan_ = {};
  state_.announce();
}

std::string SwitchCoordinator::under_way() const {
  if (!present_) return "";
  return "switch " + std::to_string(present_->begun.number) + " to " +
         control::set_text(present_->begun.order.after, state_.spec()) + ", asked for by " +
         asker_text(present_->begun, state_.spec());
}

std::string SwitchCoordinator::progress() const {
  const PlanWord plan = agreement().plan();
  const std::string until = plan.is_open() ? ", until " + time_of_day(present_->begun.order.until) : "";
  return phase_word(plan.phase) + until;
}

bool SwitchCoordinator::is_free() const noexcept {
  const PlanWord open = agreement().plan();
  return !present_ && !open.is_open() && (open.number == 0 || orders_.are_over(open.number, UINT16_MAX));
}

/// Judges the request. If the switch may begin, `end` is kDone, because no error has occurred yet.
void SwitchCoordinator::assess(TaskBits& target, SwitchOutcome& outcome) {
  SwitchReceipt& receipt = outcome.receipt;
  const PlanAnswer answer = orders_.judge(target, receipt.cause);
  receipt.before = orders_.set_in_force();
  receipt.on_before = orders_.on();
  receipt.after = set_of(state_.spec(), target);
  receipt.why = answer.why;
  receipt.task = answer.task;
  receipt.way = orders_.way();
  if (present_) {
    receipt.said.assign(under_way() + ", is under way: " + progress());
    outcome.remedy = way_out();
  } else if (!is_free()) {
    receipt.said.assign("the rtpus are not done with the last switch");
    outcome.remedy = way_out();
  } else if (!state_.logic.is_settled()) {
    receipt.said.assign("tasks are being brought up");
    outcome.remedy = way_out("`chimera status` shows which; ask again when they are ON");
  }
  if (!receipt.said.view().empty()) {
    receipt.why = NoSwitch::kUnderWay;
    receipt.task = {};
  }
  const bool is_in_force = receipt.why == NoSwitch::kNothingToDo;
  const bool may_begin = receipt.why == NoSwitch::kNone;
  if (!may_begin) receipt.way.slow = 0;
  receipt.end = may_begin ? SwitchEnd::kDone : is_in_force ? SwitchEnd::kNothingToDo : SwitchEnd::kRefused;
  const std::string task = receipt.task.is_valid() ? state_.name(receipt.task) : "";
  if (receipt.why == NoSwitch::kInError) outcome.remedy = "`chimera clear " + task + "`";
  if (receipt.why == NoSwitch::kKeptOff) outcome.remedy = "`chimera on " + task + "`";
  if (receipt.why == NoSwitch::kNotCreated) outcome.remedy = "`chimera spawn " + task + "`";
}

ForeseenSwitch SwitchCoordinator::foresee(TaskBits target) {
  SwitchOutcome outcome;
  assess(target, outcome);
  const bool has_plan = outcome.receipt.end == SwitchEnd::kDone;
  ForeseenSwitch foreseen;
  foreseen.receipt = outcome.receipt;
  foreseen.remedy = outcome.remedy;
  if (!has_plan) return foreseen;
  foreseen.plan = orders_.plan();
  foreseen.expected = expected();
  find_late_off(foreseen);
  return foreseen;
}

/// Skips slow switches: they do not wait longer for a gap.
void SwitchCoordinator::find_late_off(ForeseenSwitch& foreseen) const {
  if (foreseen.receipt.way.slow != 0) return;
  const TaskBits after = target_of(foreseen.plan);
  for (const TaskId task : foreseen.plan.leaving) {
    const TaskSpec& spec = state_.spec().tasks[task.index];
    const Nanoseconds needed = IdleGap::needed(spec, state_.profile(task), Method::kOff);
    if (!members_.needs_gaps(task) || needed <= longest_gap(state_.spec(), after, spec.rtpu)) continue;
    foreseen.late_off = task;
    foreseen.needed = needed;
    return;
  }
}

/// Estimated time to the change, if only the flag must be waited for. Requires: orders_ has judged.
Nanoseconds SwitchCoordinator::expected() {
  Nanoseconds sum;
  const std::uint8_t slow = orders_.way().slow;
  if (slow == 0) {
    for (const TaskId task : orders_.plan().arriving) sum = sum + method_time(state_, task, Method::kOn);
    return sum + orders_.lead();
  }
  const Method methods[] = {Method::kCycle, Method::kOff, Method::kKill, Method::kInit, Method::kReinit, Method::kOn};
  static_assert(std::size(methods) == static_cast<std::size_t>(SlowAct::kOn) + 1);
  for (const SlowStep& step : slow_.plan(orders_.plan(), orders_.constants_in_force(), slow))
    if (step.act != SlowAct::kCheck) sum = sum + method_time(state_, step.task, methods[static_cast<int>(step.act)]);
  return (slow & kSlowForConstants) != 0 ? sum + flag_lead(state_.spec(), orders_.on()) : sum;
}

void SwitchCoordinator::ask(const SwitchRequest& request, TaskBits target, Asker asked_by, Nanoseconds wait,
                            Nanoseconds now, Switched switched) {
  look(now);
  auto outcome = std::make_shared<SwitchOutcome>();
  outcome->receipt.asked = now;
  outcome->receipt.cause = request.cause;
  outcome->receipt.by = request.by;
  assess(target, *outcome);
  BegunSwitch begun;
  begun.number = journal_.next();
  begun.cause = request.cause;
  begun.by = request.by;
  begun.asked_by = asked_by;
  begun.asked = now;
  if (outcome->receipt.end == SwitchEnd::kNothingToDo) return switched(*outcome);
  if (outcome->receipt.end == SwitchEnd::kRefused) {
    outcome->receipt.number = begun.number;
    std::vector<Switched> one;
    one.push_back(std::move(switched));
    return file(std::move(outcome), begun, now, std::move(one));
  }
  orders_.make(begun, target, now + wait);
  journal_.begin(begun);
  present_ = Present{begun, {}};
  present_->switched.push_back(std::move(switched));
  announce();
  state_.tell("switch", TaskId{}, RtpuId{}, under_way() + ": begun", now);
}

/// Notes in the journal who cancelled before it aborts the plan, because a successor may have to report it.
bool SwitchCoordinator::cancel(Asker cancelled_by, Switched switched) {
  if (!present_) return false;
  BegunSwitch cancelled = present_->begun;
  cancelled.cancelled_by = cancelled_by;
  journal_.change(cancelled);
  if (!orders_.abort(cancelled)) {
    journal_.change(present_->begun);
    return false;
  }
  present_->begun = cancelled;
  present_->switched.push_back(std::move(switched));
  return true;
}

Nanoseconds SwitchCoordinator::next_due() const noexcept {
  if (!present_) return kNever;
  const bool is_open = agreement().plan().is_open();  // if it is not open, the rtpus ring
  return is_open ? present_->begun.order.until + kGrace : overdue_at();
}

bool SwitchCoordinator::is_tried_again(const SwitchReceipt& receipt, Nanoseconds now) {
  const bool is_cancelled = present_->begun.cancelled_by.role != control::Role::kNone;
  if (is_cancelled || present_->damaged_at != kNever || state_.is_ending()) return false;
  if (!orders_.make_next_try(present_->begun, receipt.why, now)) return false;
  journal_.change(present_->begun);
  announce();
  return true;
}

/// Aborts an open plan that the journal does not contain: no manager follows it.
void SwitchCoordinator::look(Nanoseconds now) {
  look_at_page(now);
  const PlanWord plan = agreement().plan();
  if (!present_ && plan.is_open() && agreement().abort(plan.number)) state_.announce();
  if (!present_) return;
  const bool is_due = now >= present_->begun.order.until + kGrace || state_.is_ending();
  if (is_due) (void)orders_.abort(present_->begun);
  const bool is_lost = present_->damaged_at != kNever && now >= present_->damaged_at + kStepPatience;
  if (!orders_.is_over(present_->begun) && !is_lost) return;
  auto outcome = collect(present_->begun, now);
  if (is_tried_again(outcome->receipt, now)) return;
  const Present over = *std::exchange(present_, std::nullopt);
  const bool is_persons = over.begun.cause == SwitchCause::kScript;
  const Acting acting(state_, is_persons ? over.begun.asked_by.text() : "");
  tell(*outcome, now);
  file(std::move(outcome), over.begun, now, over.switched);
}

void SwitchCoordinator::announce() {
  last_ = present_->begun.order;
  last_plan_ = {};
  orders_.announce(present_->begun);
}

/// Writes the last order anew if something has overwritten the page. A switch that was not committed is then aborted; a
/// slow one takes back all steps.
void SwitchCoordinator::look_at_page(Nanoseconds now) {
  if (!last_) return;
  const SwitchOrder& order = *last_;
  if (!agreement().is_overwritten(order.number)) {
    last_plan_ = agreement().plan();
    return;
  }
  std::uint16_t turn = 0;
  if (order.slow != 0 && orders_.find_plan_of(order))
    turn = static_cast<std::uint16_t>(TurnWord::kBack |
                                      slow_.plan(orders_.plan(), order.constants, order.slow).size());
  if (last_plan_.phase != SwitchPhase::kCommitted) last_plan_ = {order.number, SwitchPhase::kAborted, 0};
  agreement().restore(order, last_plan_, turn);
  state_.announce();
  if (present_ && present_->damaged_at == kNever) present_->damaged_at = now;
}

std::uint64_t SwitchCoordinator::words_of_progress() const {
  std::uint64_t words = state_.page.switching.plan.load(std::memory_order_acquire);
  words = words * 31 + state_.page.switching.turn.load(std::memory_order_acquire);
  for (std::uint32_t r = 0; r < state_.peers.n_rtpus(); ++r) {
    if (!state_.peers[RtpuId(r)].is_there()) continue;
    const SwitchProgress& progress = state_.peers[RtpuId(r)].block().head().switching;
    words = (words * 31 + progress.adopted) * 31 + progress.over;
  }
  return words;
}

/// A job of a task that leaves may take its whole period.
Nanoseconds SwitchCoordinator::overdue_at() const noexcept {
  Nanoseconds longest;
  for (const TaskSpec& task : state_.spec().tasks)
    if (!task.aperiodic) longest = std::max(longest, task.period);
  return std::max(present_->begun.order.until, present_->moved_at) + kStepPatience + longest;
}

std::vector<RtpuId> SwitchCoordinator::held_up_by() {
  const SwitchOrder& order = present_->begun.order;
  const PlanWord plan = agreement().plan();
  std::vector<RtpuId> busy, late;
  for (std::uint32_t r = 0; r < state_.peers.n_rtpus(); ++r) {
    if (((order.members >> r) & 1u) == 0 || !members_.is_busy_with(r, order.number)) continue;
    const SwitchProgress& progress = state_.peers[RtpuId(r)].block().head().switching;
    busy.emplace_back(r);
    if (progress.adopted.load(std::memory_order_acquire) != order.number) late.emplace_back(r);  // SwitchProgress
  }
  if (plan.phase == SwitchPhase::kCommitted) return late.empty() ? busy : late;  // the others wait for these
  const auto run = agreement().run(order.number);
  if (order.slow == 0 || !run || !orders_.find_plan_of(order)) return busy;
  const SlowCourse course(slow_.plan(orders_.plan(), order.constants, order.slow));
  const auto step = course.turn_at(*run);
  if (!step) return busy;
  const RtpuId next = state_.spec().tasks[course.steps()[*step].task.index].rtpu;
  return std::ranges::find(busy, next) == busy.end() ? busy : std::vector<RtpuId>{next};
}

/// Leaves an rtpu that does not run to RtpuWatch: a debugger may hold it.
std::vector<RtpuId> SwitchCoordinator::overdue(Nanoseconds now) {
  if (!present_ || state_.is_ending()) return {};
  const std::uint64_t words = words_of_progress();
  if (std::exchange(present_->words, words) != words) present_->moved_at = now;
  if (now < overdue_at()) return {};
  present_->moved_at = now;
  std::vector<RtpuId> over;
  for (const RtpuId rtpu : held_up_by()) {
    RtpuRecord& record = state_.rtpus[rtpu.index];
    if (record.is_away) continue;
    record.ended_for = "it held up switch " + std::to_string(present_->begun.number);
    if (!record.hang.empty()) record.ended_for += ": " + record.hang;
    over.push_back(rtpu);
  }
  return over;
}

std::string SwitchCoordinator::way_out(const std::string& otherwise) const {
  for (std::uint32_t r = 0; r < state_.peers.n_rtpus(); ++r) {
    const RtpuRecord& record = state_.rtpus[r];
    if (!record.is_alive || record.hang.empty()) continue;
    const std::string name = state_.name(RtpuId(r));
    return "`kill -KILL " + std::to_string(record.pid) + "` restarts rtpu " + name + ", which hangs: " + record.hang;
  }
  return otherwise;
}

std::shared_ptr<SwitchOutcome> SwitchCoordinator::collect(const BegunSwitch& over, Nanoseconds now) {
  auto outcome = std::make_shared<SwitchOutcome>();
  SwitchReceipt& receipt = outcome->receipt;
  outcome->tasks.resize(state_.spec().tasks.size());
  outcome->variables.resize(state_.spec().variables.size());
  outcome->reinitialised.resize(state_.spec().tasks.size());
  receipt.tasks = outcome->tasks;
  receipt.variables = outcome->variables;
  receipt.reinitialised = outcome->reinitialised;
  NoSwitch otherwise = NoSwitch::kMemberDied;
  if (state_.is_ending()) otherwise = NoSwitch::kRunEnded;
  else if (present_->damaged_at != kNever) otherwise = NoSwitch::kDamaged;
  else if (now >= over.order.until + kGrace) otherwise = NoSwitch::kNoAnswer;
  orders_.look();
  orders_.collect(over, otherwise, now, receipt);
  outcome->tasks.resize(receipt.tasks.size());
  outcome->variables.resize(receipt.variables.size());
  outcome->reinitialised.resize(receipt.reinitialised.size());
  if (state_.is_ending() && receipt.why == NoSwitch::kDisturbed) {  // every task goes OFF at the end
    receipt.why = NoSwitch::kRunEnded;
    receipt.task = {};
  }
  if (over.cancelled_by.role != control::Role::kNone && receipt.end == SwitchEnd::kAborted) {
    receipt.why = NoSwitch::kCancelled;
    receipt.said.assign(over.cancelled_by.text());
  }
  return outcome;
}

void SwitchCoordinator::file(std::shared_ptr<SwitchOutcome> outcome, const BegunSwitch& of, Nanoseconds now,
                             std::vector<Switched> switched) {
  outcome->json = control::receipt_json(outcome->receipt, state_.spec(), state_.keeper.origin,
                                        {asker_text(of, state_.spec()), wall_ns(of.asked)});
  archive_.add(of.number, outcome->json, now, [outcome, switched = std::move(switched)] {
    for (const Switched& one : switched) one(*outcome);
  });
}

void SwitchCoordinator::tell(const SwitchOutcome& outcome, Nanoseconds now) {
  const ApplicationSpec& spec = state_.spec();
  const std::string text = control::receipt_text(outcome.receipt, spec, state_.zero());
  state_.tell("switch", TaskId{}, RtpuId{}, text.substr(0, text.find('\n')), now);
  for (const std::string& line : control::bump_lines(outcome.receipt, spec))
    state_.tell("bump", TaskId{}, RtpuId{}, line, now);
}

}  // namespace chimera::manager
