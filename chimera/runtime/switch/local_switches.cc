// SPDX-License-Identifier: Apache-2.0
// Orders the switches of contexts that this process sees as they are.
#include "chimera/runtime/switch/local_switches.h"

#include <algorithm>
#include <utility>

#include "chimera/base/assert.h"

namespace chimera {

void LocalSwitches::prepare(const ApplicationSpec& spec, std::uint32_t n_contexts, std::size_t n_receipts,
                            AskedTasks* asked, SetupMemory& memory) {
  CHIMERA_ASSERT(spec.tasks.size() <= kMaxSwitchedTasks && n_contexts <= kMaxContexts);
  spec_ = &spec;
  asked_ = asked;
  members_ = memory.take<Member>(n_contexts);
  for (std::uint32_t c = 0; c < n_contexts; ++c) {
    members_[c].all = this;
    members_[c].me = c;
  }
  orders_.prepare(spec, n_contexts == 1, memory);
  receipts_.prepare(spec, n_receipts, memory);
}

void LocalSwitches::join(std::uint32_t context, TaskSet& tasks, bool needs_gaps) {
  members_[context].tasks = &tasks;
  members_[context].needs_gaps = needs_gaps;
}

void LocalSwitches::die(std::uint32_t context) noexcept {
  if (context < members_.size()) members_[context].is_dead = true;
}

// All tasks are in a context that is alone, whatever their rtpus are.
const LocalSwitches::Member& LocalSwitches::member_of(TaskId task) const noexcept {
  return members_[members_.size() == 1 ? 0 : spec_->tasks[task.index].rtpu.index];
}

std::uint16_t LocalSwitches::living() const noexcept {
  std::uint32_t living = 0;
  for (const Member& each : members_)
    if (each.tasks != nullptr && !each.is_dead) living |= 1u << each.me;
  return static_cast<std::uint16_t>(living);
}

TaskStatus LocalSwitches::status(TaskId id) const noexcept {
  const Member& member = member_of(id);
  if (member.tasks == nullptr) return {};
  const Task& task = member.tasks->tasks()[id.index];
  const State state = task.shown_state();
  const bool is_lost = member.is_dead && state != State::kNotCreated;
  return {is_lost ? State::kError : state, member.is_dead || task.in_service()};
}

Profile LocalSwitches::profile(TaskId task) const noexcept {
  const Member& member = member_of(task);
  return member.tasks == nullptr ? Profile() : member.tasks->tasks()[task.index].profile;
}

const MadeConstants& LocalSwitches::constants() noexcept {
  const auto lives = [](const Member& each) { return each.tasks != nullptr && !each.is_dead; };
  const auto found = std::find_if(members_.begin(), members_.end(), lives);
  CHIMERA_ASSERT(found != members_.end());
  ContextConstants& constants = found->tasks->constants();
  constants.read_foreign();
  return constants;
}

bool LocalSwitches::is_busy_with(std::uint32_t context, std::uint16_t plan) const noexcept {
  return (living() >> context & 1u) != 0 && members_[context].shown.over != plan;
}

bool LocalSwitches::read_part(std::uint32_t context, std::uint16_t plan, SwitchReceipt& part) const noexcept {
  const SwitchReceipt* const there = members_[context].part;
  if (there == nullptr || there->number != plan) return false;
  part = *there;
  return true;
}

void LocalSwitches::Member::tell_adopted(std::uint16_t number) noexcept {
  shown.adopted = number;
  all->show(me);
}

void LocalSwitches::Member::tell_over(const SwitchReceipt& receipt) noexcept {
  part = &receipt;
  if (receipt.ended != kNever) all->latest_ = std::max(all->latest_, receipt.ended);
  shown.adopted = receipt.number;
  shown.over = receipt.number;
  all->ring();
}

void LocalSwitches::Member::wish(const SwitchRequest& request, bool changes_nothing, Nanoseconds) noexcept {
  SwitchRequest& last = all->wish_;
  if (is_new_wish(request.is_for(last), changes_nothing, static_cast<bool>(last))) last = request;
}

void LocalSwitches::note_word(TaskId task, Signal signal) noexcept {
  if (signal == Signal::kOff || signal == Signal::kKill) kept_off_.add(task);
  if (signal == Signal::kOn) kept_off_.remove(task);
}

void LocalSwitches::note_word(const TaskBits& on, const TaskBits& off) noexcept {
  for (const TaskId id : spec_->on_order) {
    if (on.has(id)) kept_off_.remove(id);
    if (off.has(id)) kept_off_.add(id);
  }
}

// Requires: tasks were looked at. False: the lists of the request would lead to no legal set.
bool LocalSwitches::find_target(SwitchRequest& request, Nanoseconds now, TaskBits& target) noexcept {
  if (!request.lists.are_there()) {
    target = tasks_of(*spec_, request.set);
    return true;
  }
  CHIMERA_ASSERT(asked_ != nullptr);
  if (!asked_->find(request, orders_.on(), now, target)) return false;
  request.set = set_of(*spec_, target);
  return true;
}

void LocalSwitches::ask(SwitchRequest request, Nanoseconds now) noexcept {
  end_if_over(now, false);
  orders_.look();
  TaskBits target;
  if (!find_target(request, now, target)) return;
  if (request.cause == SwitchCause::kScript) note_word(target, request.lists.minus);
  const PlanAnswer answer = is_under_way() ? PlanAnswer{NoSwitch::kUnderWay, {}} : orders_.judge(target, request.cause);
  if (answer) request.set = orders_.plan().after;
  const bool is_nothing = answer.why == NoSwitch::kNothingToDo;
  if (is_nothing && request.cause != SwitchCause::kScript) return;
  const std::uint32_t number = is_nothing ? 0 : receipts_.next_number();
  if (!answer && reader_ != nullptr) {
    SwitchReceipt told;
    told.number = number;
    note_request(told, request, orders_.set_in_force(), orders_.on(), {}, now);
    refuse(told, answer);
    return reader_->take(told);
  }
  if (is_under_way() && !receipts_.has_room()) return receipts_.leave_out();  // the last place is that of the present
  SwitchReceipt& receipt = receipts_.add();
  receipt.number = number;
  note_request(receipt, request, orders_.set_in_force(), orders_.on(), answer ? orders_.way() : SwitchWay(), now);
  if (!answer) return refuse(receipt, answer);
  present_ = {};
  present_.number = number;
  present_.cause = request.cause;
  present_.by = request.by;
  present_.asked = latest_ = now;
  orders_.make(present_, target, now + kSwitchPatience);
  receipt_ = &receipt;
  orders_.announce(present_);
}

bool LocalSwitches::look(Nanoseconds now) noexcept {
  if (!is_under_way() && !wish_) return false;
  const std::uint16_t last = orders_.agreement().plan().number;
  end_if_over(now, false);
  if (wish_ && is_under_way() && present_.leads_to(wish_)) wish_ = {};
  if (wish_ && !is_under_way()) ask(std::exchange(wish_, {}), now);
  return orders_.agreement().plan().number != last;
}

void LocalSwitches::end_if_over(Nanoseconds now, bool is_run_over) noexcept {
  if (!is_under_way() || !(is_run_over || orders_.is_over(present_))) return;
  const NoSwitch otherwise = is_run_over ? NoSwitch::kRunEnded : NoSwitch::kMemberDied;
  orders_.collect(present_, otherwise, std::max(now, latest_), *receipt_);
  if (!is_run_over && orders_.make_next_try(present_, receipt_->why, now)) return orders_.announce(present_);
  if (reader_ != nullptr) {
    reader_->take(*receipt_);
    receipts_.clear();
  }
  receipt_ = nullptr;
}

// A plan that no context has taken up yet is open still.
void LocalSwitches::end(Nanoseconds now) noexcept {
  if (is_under_way()) (void)orders_.abort(present_);
  end_if_over(now, true);
}

}  // namespace chimera
