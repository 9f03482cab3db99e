// SPDX-License-Identifier: Apache-2.0
// Tasks behind servers in virtual time: their events, and whether their jobs may run now.
#include <algorithm>

#include "chimera/runtime/virtual/preemptive.h"

namespace chimera {

// The periods of servers count from the origin of the grid.
void Preemptive::open_servers() noexcept {
  if (has_begun_) return;
  has_begun_ = true;
  for (SporadicTask& s : sporadic_) s.job.start(releases_.origin());
}

Preemptive::SporadicTask* Preemptive::sporadic(TaskId task) noexcept {
  if (!tasks_[task.index].server) return nullptr;
  return &*std::find_if(sporadic_.begin(), sporadic_.end(), [task](const SporadicTask& s) { return s.task == task; });
}

Nanoseconds Preemptive::next_server(Nanoseconds now) noexcept {
  Nanoseconds next = kNever;
  for (const SporadicTask& s : sporadic_) {
    if (active_[s.task.index].is_demoted) continue;
    if (!s.job.has_event()) {
      if (releases_.task(s.task).events > 0) return now;
      continue;
    }
    next = std::min(next, s.job.next_change(now));
    if (running_ == s.task) next = std::min(next, now + s.job.allowance(now));
  }
  return next;
}

void Preemptive::follow_servers(Nanoseconds now) noexcept {
  for (SporadicTask& s : sporadic_)
    if (accept_event(s, now)) apply_grant(s, now);
}

// True when the server has a job.
bool Preemptive::accept_event(SporadicTask& s, Nanoseconds now) noexcept {
  if (active_[s.task.index].is_demoted) return false;  // below all others no server counts
  Task& task = releases_.task(s.task);
  if (releases_.members().is_on(s.task)) return s.job.accept(task.events, now);
  Job forgotten;
  if (s.is_ready) (void)releases_.queue().remove(s.task, forgotten);
  if (s.job.forget()) ++task.profile.events_lost;
  s.is_ready = false;
  return false;
}

// Puts the job where it belongs by what the server has: on the processor, into the queue, or nowhere.
void Preemptive::apply_grant(SporadicTask& s, Nanoseconds now) noexcept {
  const SporadicJob::Grant grant = s.job.grant(now);
  Active& a = active_[s.task.index];
  if (running_ == s.task) {
    a.job.deadline = s.job.deadline();
    if (!grant.may_run) halt(s, now);
    return;
  }
  Job waiting;
  if (s.is_ready && (grant.has_another_deadline || !grant.may_run)) (void)releases_.queue().remove(s.task, waiting);
  if (grant.may_run && (grant.has_another_deadline || !s.is_ready)) {
    const Nanoseconds remaining = a.has_begun ? a.remaining : tasks_[s.task.index].budget;
    releases_.queue().put_back({s.task, s.job.release(), s.job.deadline()}, remaining);
  }
  s.is_ready = grant.may_run;
}

// The job leaves the processor until its server has capacity again.
void Preemptive::halt(SporadicTask& s, Nanoseconds now) noexcept {
  leave_processor();
  releases_.tap().record(TapKind::kPreempt, now, s.task, 0);
  ++releases_.task(s.task).profile.exhausted;
  ++releases_.task(s.task).profile.preempted;
  running_ = TaskId();
  s.is_ready = false;
}

// The job of the task is over, or never began.
void Preemptive::finish_event(TaskId task) noexcept {
  SporadicTask* s = sporadic(task);
  if (s == nullptr) return;
  s->job.finish();
  s->is_ready = false;
}

// As the failures of time see it: only its server is due at an instant.
Job Preemptive::without_server(Job job) noexcept {
  if (tasks_[job.task.index].server) job.deadline = kNever;
  return job;
}

}  // namespace chimera
