// SPDX-License-Identifier: Apache-2.0
// Accepts the events of tasks behind servers and applies what their servers grant.
#include "chimera/runtime/virtual/sporadic_tasks.h"

#include <algorithm>

namespace chimera {

SporadicTasks::SporadicTasks(Releases& releases, std::span<const TaskSpec> tasks, VirtualProcessor& processor)
    : releases_(releases), tasks_(tasks), processor_(processor) {
  for (std::uint32_t i = 0; i < tasks.size(); ++i)
    if (tasks[i].server) sporadic_.push_back({TaskId(i), SporadicJob(*tasks[i].server)});
}

void SporadicTasks::open() noexcept {
  if (is_open_) return;
  is_open_ = true;
  for (SporadicTask& s : sporadic_) s.job.start(releases_.origin());
}

SporadicTasks::SporadicTask* SporadicTasks::find(TaskId task) noexcept {
  if (!tasks_[task.index].server) return nullptr;
  return &*std::find_if(sporadic_.begin(), sporadic_.end(), [task](const SporadicTask& s) { return s.task == task; });
}

Nanoseconds SporadicTasks::next_change(Nanoseconds now) noexcept {
  Nanoseconds next = kNever;
  for (const SporadicTask& s : sporadic_) {
    if (processor_.of(s.task).is_demoted) continue;
    if (!s.job.has_event()) {
      if (releases_.task(s.task).events > 0) return now;
      continue;
    }
    next = std::min(next, s.job.next_change(now));
    if (processor_.running() == s.task) next = std::min(next, now + s.job.allowance(now));
  }
  return next;
}

void SporadicTasks::follow(Nanoseconds now) noexcept {
  for (SporadicTask& s : sporadic_)
    if (accept_event(s, now)) apply_grant(s, now);
}

// True when the server has a job.
bool SporadicTasks::accept_event(SporadicTask& s, Nanoseconds now) noexcept {
  if (processor_.of(s.task).is_demoted) return false;  // below all others no server counts
  Task& task = releases_.task(s.task);
  if (releases_.members().is_on(s.task)) return s.job.accept(task.events, now);
  Job forgotten;
  if (s.is_ready) (void)releases_.queue().remove(s.task, forgotten);
  if (s.job.forget()) ++task.profile.events_lost;
  s.is_ready = false;
  return false;
}

// Moves the job by the capacity of its server: onto the processor, into the queue, or out of both.
void SporadicTasks::apply_grant(SporadicTask& s, Nanoseconds now) noexcept {
  const SporadicJob::Grant grant = s.job.grant(now);
  BegunJob& a = processor_.of(s.task);
  if (processor_.running() == s.task) {
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
void SporadicTasks::halt(SporadicTask& s, Nanoseconds now) noexcept {
  processor_.take();
  releases_.tap().record(TapKind::kPreempt, now, s.task, 0);
  ++releases_.task(s.task).profile.exhausted;
  ++releases_.task(s.task).profile.preempted;
  s.is_ready = false;
}

void SporadicTasks::charge(TaskId task, Nanoseconds used) noexcept {
  if (SporadicTask* s = find(task); s != nullptr && !processor_.of(task).is_demoted) s->job.charge(used);
}

void SporadicTasks::finish(TaskId task) noexcept {
  SporadicTask* s = find(task);
  if (s == nullptr) return;
  s->job.finish();
  s->is_ready = false;
}

Job SporadicTasks::without_server(Job job) const noexcept {
  if (tasks_[job.task.index].server) job.deadline = kNever;
  return job;
}

}  // namespace chimera
