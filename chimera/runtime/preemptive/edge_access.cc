// SPDX-License-Identifier: Apache-2.0
// Tasks as the cycle boundary of a preemptive context sees them.
#include "chimera/runtime/preemptive/edge_access.h"

#include <algorithm>
#include <utility>

namespace chimera {

EdgeAccess::EdgeAccess(Releases& releases, ReadyJobs& ready, Processor& processor, JobClock& clock,
                       std::size_t n_tasks)
    : releases_(releases), ready_(ready), processor_(processor), clock_(clock), look_ups_(n_tasks) {}

void EdgeAccess::attach() noexcept { thread_ = this_thread(); }

bool EdgeAccess::claim(TaskId task) noexcept {
  JobThread& job = *ready_.of(task);
  if (job.phase.try_claim()) {
    job.next_release = job.job.release;  // it comes again
    processor_.cancel(job, clock_.now());
    return true;
  }
  const bool is_free = job.phase.is_free();
  job.is_awaited = job.is_awaited || !is_free;
  return is_free;
}

Nanoseconds EdgeAccess::used_by_job(TaskId task) noexcept {
  const JobThread* job = ready_.of(task);
  return job != nullptr && job->phase.is_running() ? job->used() : Nanoseconds{};
}

bool EdgeAccess::is_blocked(TaskId task) noexcept { return look_ups_[task.index].is_blocked; }

Answer EdgeAccess::call(Task& task, Method method, Nanoseconds now) noexcept {
  JobThread* const job = leave_for(task.id);
  const Answer answer = call_method(task, method, now);
  if (job != nullptr) return_from(*job);
  return answer;
}

Nanoseconds EdgeAccess::latest_release() const noexcept {
  Nanoseconds latest{INT64_MIN / 2};
  for (const JobThread& job : std::as_const(ready_).threads()) latest = std::max(latest, job.job.release);
  return latest;
}

bool EdgeAccess::has_job_before(TaskId task, Nanoseconds at) const noexcept {
  const JobThread* job = std::as_const(ready_).of(task);
  return job != nullptr && (!job->phase.is_free() || (job->is_on && job->next_release < at));
}

void EdgeAccess::await_job(TaskId task) noexcept {
  if (JobThread* job = ready_.of(task); job != nullptr) job->is_awaited = true;
}

void EdgeAccess::hold_releases(Nanoseconds from) noexcept {
  for (JobThread& job : ready_.threads()) job.release_end = std::min(end_, from);
}

void EdgeAccess::let_release(TaskId task) noexcept {
  JobThread* job = ready_.of(task);
  if (job == nullptr) return;
  job->release_end = end_;
  follow(*job, job->next_release <= clock_.now());
}

void EdgeAccess::open(Nanoseconds until) noexcept {
  for (JobThread& job : ready_.threads()) {
    job.release_end = job.release_end == end_ ? until : std::min(job.release_end, until);  // some are held
    follow(job, true);
  }
  end_ = until;
}

void EdgeAccess::follow_all() noexcept {
  for (JobThread& job : ready_.threads()) follow(job, false);
}

void EdgeAccess::follow(JobThread& job, bool is_new) noexcept {
  const bool is_on = releases_.members().is_on(job.id), has_event = job.sporadic && job.task.events > 0;
  is_new = is_new || is_on != job.is_on || job.is_held || has_event;
  const bool is_released = is_on && !job.is_on && !job.sporadic;
  if (is_released) job.next_release = releases_.queue().classes().first_release(job.id.index);
  if (!is_on) job.next_release = kNever;
  if (!is_on && job.sporadic && job.sporadic->job().forget()) ++job.task.profile.events_lost;
  job.is_on = is_on;
  job.is_held = false;
  if (is_new) job.wake();
}

// Out of the section, to the label of the task; null: stays.
JobThread* EdgeAccess::leave_for(TaskId task) noexcept {
  JobThread* const job = ready_.of(task);
  if (job == nullptr || thread_ == 0 || !job->phase.is_free()) return nullptr;
  const Nanoseconds now = clock_.now(), deadline = now + job->spec.deadline;
  job->is_held = true;
  job->carrier = thread_;
  job->job = {task, now, deadline};
  job->phase.begin_method();
  const int level = ready_.insert(*job, deadline, job->spec.budget, job);
  processor_.leave();
  ready_.lower(level);
  return job;
}

void EdgeAccess::return_from(JobThread& job) noexcept {
  job.phase.end_method();
  ready_.raise();
  processor_.enter();
  ready_.remove(job);
  job.carrier = job.thread();
  job.phase.retire();
  processor_.show_running();
}

bool EdgeAccess::collect_late(Nanoseconds now) noexcept {
  bool are_some = false;
  for (const JobThread& job : ready_.threads()) {
    LookUp& look_up = look_ups_[job.id.index];
    look_up.is_due = !look_up.is_done && releases_.settlement().has_unreported_miss(job.id, now) &&
                     job.phase.is_running();
    are_some = are_some || look_up.is_due;
  }
  return are_some;
}

void EdgeAccess::look_up_blocked() noexcept {
  for (const JobThread& job : ready_.threads()) {
    LookUp& look_up = look_ups_[job.id.index];
    if (!look_up.is_due) continue;
    look_up = {false, true, is_asleep(job.thread())};
  }
}

void EdgeAccess::forget_blocked() noexcept {
  for (LookUp& look_up : look_ups_) look_up = {};
}

}  // namespace chimera
