// SPDX-License-Identifier: Apache-2.0
// Handles the results of jobs that others must see.
#include "chimera/runtime/life/settlement.h"

#include <utility>

#include "chimera/base/mechanisms.h"

namespace chimera {

void Settlement::settle_job(TaskId id, Nanoseconds now) noexcept {
  settle_at_once(id, now);
  parts_.records[id.index].left.store(0, std::memory_order_relaxed);
  settle(parts_.set.tasks()[id.index], now);
}

void Settlement::settle_at_once(TaskId id, Nanoseconds now) noexcept {
  std::uint8_t left = parts_.records[id.index].left.fetch_and(JobRecord::kSettle, std::memory_order_relaxed);
  const Task& task = parts_.set.tasks()[id.index];
  if (task.standing == Standing::kWarm) left &= JobRecord::kFindCause;  // no task reads its outputs
  const TaskSpec& spec = *task.spec;
  if (left & JobRecord::kRaiseFlag) raise_flag(id, State::kOn, now);
  if (left & JobRecord::kStop) stop(id);
  if constexpr (mechanisms::kSwitch) {
    SentSignals& sent = parts_.set.sent();
    if (left & JobRecord::kSwitchForMiss) sent.request({spec.on_miss_set, SwitchCause::kMiss, id});
    if (left & JobRecord::kSwitchForOverrun) sent.request({spec.on_overrun_set, SwitchCause::kOverrun, id});
  }
  publish();
  if (!mechanisms::kBlame || !(left & JobRecord::kFindCause)) return;
  if (const auto verdict = parts_.cause->judge(id, now)) parts_.guest->missed(id, *verdict, now);
}

void Settlement::publish() noexcept {
  if (parts_.guest != nullptr && !parts_.set.changes().is_empty()) parts_.guest->publish();
}

void Settlement::settle(Task& task, Nanoseconds now) noexcept {
  record_faults(task);
  if (task.is_tapped) parts_.tap.append_row(task);
  if (task.standing == Standing::kWarm) task.forget_sent();
  if (task.has_sent()) parts_.set.sent().deliver(task);
  if (task.state != State::kOn) {
    parts_.set.on_set_changed();
    follow_error(task, now);
    parts_.members.follow(task, now);
  }
  publish();
}

void Settlement::record_faults(Task& task) noexcept {
  JobRecord& record = parts_.records[task.id.index];
  if (task.faults.told == record.told_seen) return;
  record.told_seen = task.faults.told;
  parts_.set.changes().add_fault(task.id);
  if (task.faults.count == record.faults_seen) return;
  record.faults_seen = task.faults.count;
  parts_.tap.record_fault(task);
}

void Settlement::follow_error(Task& task, Nanoseconds now) noexcept {
  const bool was_told = std::exchange(task.is_error_told, task.state == State::kError);
  if (was_told || task.state != State::kError) return;
  if (mechanisms::kRestart && task.spec->on_fault == OnFault::kRestart) return parts_.set.sent().want_edge();
  react_to_fault(task, task.spec->on_fault, now);
}

void Settlement::react_to_fault(Task& task, OnFault reaction, Nanoseconds now) noexcept {
  if (reaction == OnFault::kFlag) raise_flag(task.id, task.state, now);
  if (reaction == OnFault::kStop) stop(task.id);
  if (mechanisms::kSwitch && reaction == OnFault::kSwitch)
    parts_.set.sent().request({task.spec->on_fault_set, SwitchCause::kFault, task.id});
}

void Settlement::stop(TaskId by) noexcept {
  if (!task_stopped_) stopped_by_ = by;
  task_stopped_ = true;
}

void Settlement::raise_flag(TaskId by, State in, Nanoseconds at) noexcept {
  if (parts_.set.flag().raises(by)) return;
  if (!parts_.set.flag().is_up()) parts_.tap.record(TapKind::kFlag, at, TaskId(), 1);
  parts_.set.flag().raise_for(by, in);
  parts_.set.on_set_changed();
}

void Settlement::give_up_starved(Nanoseconds now) noexcept {
  parts_.misses.clear_lost_patience();
  for (Task& task : parts_.set.tasks()) {
    if (!parts_.members.is_on(task.id) || task.is_busy || !MissPolicy::is_out_of_patience(task)) continue;
    parts_.misses.give_up(task, now);
    settle(task, now);
  }
}

}  // namespace chimera
