// SPDX-License-Identifier: Apache-2.0
// Changes states, bindings and releases of one context at the instant of a switch.
#include "chimera/runtime/switch/changeover.h"

#include <algorithm>

namespace chimera {

// Tasks with threads take their releases themselves.
void Changeover::release_before(Nanoseconds instant) noexcept {
  if (threads_.run_beside_methods()) return;
  queue_.release_due(instant - Nanoseconds{1}, [this](const DroppedRelease& dropped) { misses_.drop(dropped); });
}

// The next release of a task has come if this context is late by more than a period.
void Changeover::change_releases(Nanoseconds at, Nanoseconds now) noexcept {
  if (threads_.run_beside_methods()) return;
  release_before(at);
  const TaskClasses& classes = queue_.classes();
  for (const Task& each : set_.tasks()) {
    if (each.is_busy || !classes.is_active(each.id.index) || !queue_.has_waiting(each.id, at)) continue;
    Job job;
    const bool is_replaced = classes[classes.class_of(each.id.index)].next <= now;
    if (is_replaced && queue_.remove(each.id, job)) misses_.drop({each.id, job.release, 1});
  }
}

void Changeover::hold(const SwitchPlan& plan, const TaskBits& before, Nanoseconds at) noexcept {
  bits_ = before;
  set_.sources().begin_handover(plan.handovers);
  set_.judge_as(&bits_);
  threads_.hold_releases(at);
}

void Changeover::make(const SwitchPlan& plan, const TaskBits& after, Nanoseconds at) noexcept {
  const bool was_illegal = set_.flag().is_up();
  for (const Task& task : set_.tasks())
    has_old_job_[task.id.index] = set_.is_mine(task.id) && threads_.has_job_before(task.id, at);
  for (const TaskId id : plan.arriving) {
    Task& arriving = set_.tasks()[id.index];
    // A signal after the commit had it turned OFF.
    if (!set_.is_mine(id) || arriving.standing != Standing::kOwesOff) continue;
    arriving.state = State::kOn;
    arriving.standing = Standing::kPlain;
  }
  set_.sources().hand_over(has_old_job_);
  for (const TaskId id : plan.leaving)
    if (set_.is_mine(id) && !has_old_job_[id.index]) leave(set_.tasks()[id.index], at);
  bits_ = after;
  set_.judge_as(&bits_);
  if (set_.flag().is_up() != was_illegal) tap_.record(TapKind::kFlag, at, TaskId(), was_illegal ? 0 : 1);
  for (const TaskId id : plan.arriving) {
    if (!set_.is_mine(id) || set_.tasks()[id.index].state != State::kOn) continue;
    members_.follow(set_.tasks()[id.index], at);
    set_.sent().deliver(set_.tasks()[id.index]);
  }
  for (const Task& task : set_.tasks()) {
    if (has_old_job_[task.id.index]) threads_.await_job(task.id);
    else threads_.let_release(task.id);
  }
}

void Changeover::leave(Task& leaving, Nanoseconds at) noexcept {
  if (leaving.state == State::kOn) {
    leaving.state = State::kOff;
    leaving.standing = Standing::kOwesOff;
  }
  members_.follow(leaving, at);
}

bool Changeover::follow(const SwitchPlan& plan, Nanoseconds at) noexcept {
  bool are_all = true, has_left = false;
  for (const Task& task : set_.tasks()) {
    bool& waits = has_old_job_[task.id.index];
    if (!waits) continue;
    waits = threads_.has_job_before(task.id, at);
    are_all = are_all && !waits;
    if (waits) threads_.await_job(task.id);
    if (waits) continue;
    set_.sources().old_job_ended(task.id);
    const bool leaves = std::find(plan.leaving.begin(), plan.leaving.end(), task.id) != plan.leaving.end();
    if (leaves) leave(set_.tasks()[task.id.index], at);
    threads_.let_release(task.id);
    has_left = has_left || leaves;
  }
  if (has_left) set_.on_set_changed();
  return are_all;
}

void Changeover::release() noexcept {
  set_.sources().end_handover();
  set_.judge_as(nullptr);
  for (const Task& task : set_.tasks()) threads_.let_release(task.id);
}

}  // namespace chimera
