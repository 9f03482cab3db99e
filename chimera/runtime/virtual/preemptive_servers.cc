// SPDX-License-Identifier: Apache-2.0
// Tasks behind servers: their events, and whether their jobs may run now.
#include <algorithm>

#include "chimera/runtime/virtual/preemptive.h"

namespace chimera {

// The periods of servers count from the origin of the grid.
void Preemptive::open_servers() noexcept {
  if (has_begun_) return;
  has_begun_ = true;
  for (Served& s : served_) s.server = ServerState(*tasks_[s.task.index].server, releases_.origin());
}

Preemptive::Served* Preemptive::served(TaskId task) noexcept {
  if (!tasks_[task.index].server) return nullptr;
  return &*std::find_if(served_.begin(), served_.end(), [task](const Served& s) { return s.task == task; });
}

Nanoseconds Preemptive::next_server(Nanoseconds now) noexcept {
  Nanoseconds next = kNever;
  for (const Served& s : served_) {
    if (active_[s.task.index].is_demoted) continue;
    if (!s.has_job) {
      if (releases_.task(s.task).events > 0) return now;
      continue;
    }
    next = std::min(next, s.server.next_change(now));
    if (running_ == s.task) next = std::min(next, now + s.server.allowance(now));
  }
  return next;
}

void Preemptive::follow_servers(Nanoseconds now) noexcept {
  for (Served& s : served_)
    if (take_event(s, now)) stand(s, now);
}

// True when the server has a job.
bool Preemptive::take_event(Served& s, Nanoseconds now) noexcept {
  Task& task = releases_.task(s.task);
  if (active_[s.task.index].is_demoted) return false;  // below all others no server counts
  if (!releases_.members().is_on(s.task)) {
    Job forgotten;
    if (s.is_ready) (void)releases_.queue().remove(s.task, forgotten);
    if (s.has_job) ++task.profile.events_lost;
    s.is_active = s.has_job = s.is_ready = false;
    return false;
  }
  if (s.has_job) return true;
  if (task.events == 0) return s.is_active = false;
  --task.events;
  if (!s.is_active) s.server.activate(now);
  s.is_active = s.has_job = true;
  s.job = {s.task, now, kNever};
  return true;
}

// Puts the job where it belongs by what the server has: on the processor, into the queue, or nowhere.
void Preemptive::stand(Served& s, Nanoseconds now) noexcept {
  s.server.follow(now);
  const bool may_run = s.server.allowance(now) > Nanoseconds{};
  const bool moves = s.job.deadline != s.server.deadline();
  s.job.deadline = s.server.deadline();
  Active& a = active_[s.task.index];
  if (running_ == s.task) {
    a.job.deadline = s.job.deadline;
    if (may_run) return;
    leave_processor();
    releases_.tap().record(TapKind::kPreempt, now, s.task, 0);
    ++releases_.task(s.task).profile.exhausted;
    ++releases_.task(s.task).profile.preempted;
    running_ = TaskId();
    s.is_ready = false;
    return;
  }
  Job waiting;
  if (s.is_ready && (moves || !may_run)) (void)releases_.queue().remove(s.task, waiting);
  if (may_run && (moves || !s.is_ready))
    releases_.queue().put_back(s.job, a.has_begun ? a.remaining : tasks_[s.task.index].budget);
  s.is_ready = may_run;
}

// The job of the task is over.
void Preemptive::forget(TaskId task) noexcept {
  Served* s = served(task);
  if (s != nullptr) s->has_job = s->is_ready = false;
}

// As the failures of time see it: only its server is due at an instant.
Job Preemptive::without_server(Job job) noexcept {
  if (tasks_[job.task.index].server) job.deadline = kNever;
  return job;
}

}  // namespace chimera
