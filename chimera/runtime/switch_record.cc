// SPDX-License-Identifier: Apache-2.0
// Measures the switch that is under way.
#include "chimera/runtime/switch_record.h"

#include <algorithm>

namespace chimera {

Nanoseconds StartDelays::begin(const Task& task) noexcept {
  const Spread now = seen_[task.id.index] = task.profile.start_delay;
  return now.count == 0 ? Nanoseconds{-1} : now.max;
}

Nanoseconds StartDelays::look(const Task& task) noexcept {
  Spread& seen = seen_[task.id.index];
  if (seen.count == kNotBegun) return (void)begin(task), Nanoseconds{-1};
  const Spread before = seen, now = seen = task.profile.start_delay;
  if (now.count <= before.count) return Nanoseconds{-1};  // spawned anew: it begins at 0
  if (before.count == 0 || now.max > before.max) return now.max;
  return Nanoseconds{(now.sum - before.sum).count / static_cast<std::int64_t>(now.count - before.count)};
}

void SwitchRecord::prepare() {
  const ApplicationSpec& spec = set_.spec();
  receipts_.prepare(spec, 1, set_.setup_memory());
  before_ = set_.setup_memory().take<std::uint64_t>(spec.tasks.size());
  cycles_ = set_.setup_memory().take<std::uint64_t>(spec.tasks.size());
  steps_.prepare();
  delays_.prepare(spec.tasks.size(), set_.setup_memory());
}

SwitchReceipt& SwitchRecord::restart() noexcept {
  receipts_.clear();
  return *(receipt_ = &receipts_.add());
}

void SwitchRecord::take_up(const SwitchPlan& plan) noexcept {
  first_cycles_by_ = kNever;
  std::size_t n = 0;
  receipt_->reinitialised = receipt_->reinitialised.first(0);
  const auto list = [&](std::span<const TaskId> ids, TaskMove move) {
    for (const TaskId id : ids) {
      TaskPart& part = receipt_->tasks.data()[n++];
      part = {};
      part.task = id;
      part.move = move;
      if (set_.tasks()[id.index].is_busy) delays_.begin_later(id);
      else part.delay_before = delays_.begin(set_.tasks()[id.index]);
      before_[id.index] = losses(id);
    }
  };
  list(plan.arriving, TaskMove::kArrives);
  list(plan.leaving, TaskMove::kLeaves);
  list(plan.staying, TaskMove::kStays);
  receipt_->tasks = {receipt_->tasks.data(), n};
  receipt_->variables = {receipt_->variables.data(), plan.handovers.size()};
  for (std::size_t h = 0; h < plan.handovers.size(); ++h) receipt_->variables[h] = {plan.handovers[h], {}, {}, {}};
  steps_.begin_watch();
}

// A task with a job under way is looked at when that has ended.
void SwitchRecord::watch() noexcept {
  for (TaskPart& part : receipt_->tasks) {
    const Task& task = set_.tasks()[part.task.index];
    if (set_.is_mine(part.task) && !task.is_busy) part.delay = std::max(part.delay, delays_.look(task));
  }
  if (receipt_->at == kNever) steps_.watch(receipt_->variables);
}

void SwitchRecord::took(TaskId task, Method method, Nanoseconds time) noexcept {
  TaskPart& part = part_of(task);
  (method == Method::kOn ? part.on : part.off) = time;
}

const VariablePart* SwitchRecord::find_too_large_step() noexcept {
  steps_.keep_last(receipt_->variables);
  for (VariablePart& part : receipt_->variables) {
    if (!set_.is_mine(part.handover.to.task)) continue;
    part.step_of_on = steps_.step_to(part.handover);
    if (part.step_of_on.is_beyond) return &part;
  }
  return nullptr;
}

void SwitchRecord::leaves(TaskId task) noexcept {
  part_of(task).lost = losses(task) - before_[task.index];
  for (const VariablePart& part : receipt_->variables)
    if (part.handover.from.task == task) steps_.keep_last_of(part.handover);
}

const VariablePart* SwitchRecord::arrives(TaskId id, Nanoseconds now) noexcept {
  follow_arrival(id, now);
  const VariablePart* found = nullptr;
  for (VariablePart& part : receipt_->variables) {
    if (part.handover.to.task != id) continue;
    const TaskId from = part.handover.from.task;
    if (from.is_valid() && !set_.is_mine(from)) steps_.keep_watched(part.handover);
    part.step_of_on = steps_.step_to(part.handover);
    if (part.step_of_on.is_beyond && found == nullptr) found = &part;
  }
  return found;
}

// Who is re-initialised again on the way back is not listed again.
void SwitchRecord::reinitialised(TaskId task) noexcept {
  const std::span<TaskId> list = receipt_->reinitialised;
  if (std::find(list.begin(), list.end(), task) == list.end()) append(receipt_->reinitialised, task);
}

// Losses and first cycles of an arriving task count from here.
void SwitchRecord::follow_arrival(TaskId id, Nanoseconds at) noexcept {
  const Task& arriving = set_.tasks()[id.index];
  before_[id.index] = losses(id);
  cycles_[id.index] = arriving.profile.cycles;
  if (first_cycles_by_ == kNever) first_cycles_by_ = at;
  if (arriving.spec->aperiodic) return;
  const Nanoseconds within = std::min(arriving.spec->period + arriving.spec->deadline, kFirstCycleWithin);
  first_cycles_by_ = std::max(first_cycles_by_, at + within);
}

void SwitchRecord::changed(const SwitchPlan& plan, Nanoseconds at) noexcept {
  receipt_->at = first_cycles_by_ = at;
  steps_.keep_last(receipt_->variables);
  for (const TaskId id : plan.leaving) part_of(id).lost = losses(id) - before_[id.index];
  for (const TaskId id : plan.arriving)
    if (set_.is_mine(id)) follow_arrival(id, at);
}

// A task with a job under way may be publishing: it is looked at when the job has ended.
void SwitchRecord::keep_last_of_leaving() noexcept {
  for (const VariablePart& part : receipt_->variables) {
    const TaskId from = part.handover.from.task;
    if (from.is_valid() && set_.is_mine(from) && !set_.tasks()[from.index].is_busy) steps_.keep_last_of(part.handover);
  }
}

bool SwitchRecord::has_cycled(TaskId id) const noexcept {
  const Task& arriving = set_.tasks()[id.index];
  return !arriving.is_busy && arriving.profile.cycles != cycles_[id.index];
}

bool SwitchRecord::is_awaited(const TaskPart& part) const noexcept {
  const Task& task = set_.tasks()[part.task.index];
  return part.move == TaskMove::kArrives && set_.is_mine(part.task) && !task.spec->aperiodic &&
         task.state == State::kOn && !has_cycled(part.task);
}

void SwitchRecord::await_first_cycles(JobThreads& threads) noexcept {
  for (const TaskPart& part : receipt_->tasks)
    if (is_awaited(part)) threads.await_job(part.task);
}

bool SwitchRecord::has_seen_first_cycles(Nanoseconds now) noexcept {
  for (VariablePart& part : receipt_->variables) {
    const TaskId to = part.handover.to.task;
    if (!set_.is_mine(to) || part.step_of_cycle.is_known) continue;
    if (!has_cycled(to)) continue;
    part.step_of_cycle = steps_.step_to(part.handover);
  }
  const auto waits = [this](const TaskPart& part) { return is_awaited(part); };
  return now >= first_cycles_by_ || std::none_of(receipt_->tasks.begin(), receipt_->tasks.end(), waits);
}

void SwitchRecord::end(SwitchEnd end, Nanoseconds now) noexcept {
  watch();
  receipt_->end = end;
  receipt_->ended = now;
  const bool was_committed = end == SwitchEnd::kDone;
  for (TaskPart& part : receipt_->tasks) {
    const bool was_on = part.move == TaskMove::kStays || (part.move == TaskMove::kArrives) == was_committed;
    if (was_on) part.lost = losses(part.task) - before_[part.task.index];
  }
}

TaskPart& SwitchRecord::part_of(TaskId id) noexcept {
  const auto is_its = [id](const TaskPart& part) { return part.task == id; };
  return *std::find_if(receipt_->tasks.begin(), receipt_->tasks.end(), is_its);
}

// Jobs count them also while an edge looks.
std::uint64_t SwitchRecord::losses(TaskId id) const noexcept {
  Profile& profile = set_.tasks()[id.index].profile;
  return count_of(profile.dropped) + count_of(profile.aborted);
}

}  // namespace chimera
