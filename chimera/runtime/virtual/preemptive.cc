// SPDX-License-Identifier: Apache-2.0
// Simulates preemptive scheduling event by event: releases, completions, deadlines, budgets and servers.
#include "chimera/runtime/virtual/preemptive.h"

#include <algorithm>

namespace chimera {

Preemptive::Preemptive(Releases& releases, std::span<const TaskSpec> tasks, ModelledClock& clock,
                       const PreemptiveOptions& options)
    : releases_(releases), tasks_(tasks), clock_(clock), options_(options), active_(tasks.size()),
      demoted_(tasks.size()) {
  const Policy policy = releases.queue().policy();
  by_laxity_ = policy == Policy::kLlf || policy == Policy::kMufLaxity;
  for (std::uint32_t i = 0; i < tasks.size(); ++i) {
    if (tasks[i].server) sporadic_.push_back({TaskId(i), SporadicJob(*tasks[i].server)});
    else if (tasks[i].on_miss == OnMiss::kAbort) abandoners_.push_back(i);
    if (tasks[i].on_miss == OnMiss::kDemote) demoters_.push_back(i);
    if (tasks[i].on_miss == OnMiss::kDemote || tasks[i].on_overrun == OnMiss::kDemote) has_demotion_ = true;
  }
}

RunEnd Preemptive::run(Nanoseconds& now, Nanoseconds until) noexcept {
  open_servers();
  releases_.look_again();
  for (;;) {
    use_processor(now);
    complete();
    if (!abandoners_.empty()) expire(now);
    if (has_demotion_) demote_due(now);
    if (releases_.must_look(now)) {
      if (releases_.stop_requested()) return RunEnd::kStopped;
      if (releases_.settlement().task_stopped()) return RunEnd::kTaskStopped;
      if (now >= until) {
        leave_processor();
        return RunEnd::kTime;
      }
      if (releases_.edge_is_due(now)) run_edge(now);
      releases_.release_due(now);
      releases_.rest(until);
    }
    if (!sporadic_.empty()) follow_servers(now);
    if (dispatch(now)) continue;
    const bool idle = !running_.is_valid() && releases_.queue().is_empty();
    if (idle && !releases_.anything_left()) return RunEnd::kNothingLeft;
    now = std::clamp(next_event(now), now, until);
  }
}

Nanoseconds Preemptive::next_event(Nanoseconds now) noexcept {
  Nanoseconds next = releases_.next_event();
  if (has_exceptions()) next = std::min(next, next_exception(now));
  if (!running_.is_valid()) return next;
  next = std::min(next, now + active_[running_.index].remaining);
  if (!by_laxity_ || releases_.queue().is_empty()) return next;
  const Nanoseconds since = now - releases_.origin();
  return std::min(next, releases_.origin() + options_.quantum * (since / options_.quantum + 1));
}

// What only tasks with the reactions abort and demote and those behind servers have.
Nanoseconds Preemptive::next_exception(Nanoseconds now) noexcept {
  return std::min({next_deadline(), next_demotion(now), next_server(now)});
}

// Deadlines lie on the grid of releases, so they are known without looking at any job.
Nanoseconds Preemptive::next_deadline() noexcept {
  Nanoseconds next = kNever;
  for (const std::uint32_t i : abandoners_) {
    Active& a = active_[i];
    const bool on = releases_.members().is_on(TaskId(i));
    if (!on) a.next_deadline = kNever;
    else if (a.next_deadline == kNever)
      a.next_deadline = releases_.queue().first_release(TaskId(i)) + tasks_[i].deadline;
    next = std::min(next, a.next_deadline);
  }
  return next;
}

Nanoseconds Preemptive::next_demotion(Nanoseconds now) noexcept {
  Nanoseconds next = kNever;
  for (const std::uint32_t i : demoters_)
    if (active_[i].has_begun && !active_[i].is_demoted) next = std::min(next, active_[i].job.deadline);
  if (!running_.is_valid()) return next;
  const Nanoseconds left = budget_left(running_);
  return left == kNever ? next : std::min(next, now + left);
}

// Of the task's job that has begun, where its end is a demotion; else kNever.
Nanoseconds Preemptive::budget_left(TaskId task) const noexcept {
  const TaskSpec& spec = tasks_[task.index];
  const Active& a = active_[task.index];
  const bool counts = spec.on_overrun == OnMiss::kDemote && spec.budget > Nanoseconds{} && !a.is_demoted;
  return counts ? std::max(spec.budget - a.used, Nanoseconds{}) : kNever;
}

void Preemptive::use_processor(Nanoseconds until) noexcept {
  if (!running_.is_valid()) return;
  Active& a = active_[running_.index];
  a.used += until - mark_;
  a.remaining -= until - mark_;
  if (sporadic_.empty()) {
    mark_ = until;
    return;
  }
  if (SporadicTask* s = sporadic(running_); s != nullptr && !a.is_demoted) s->job.charge(until - mark_);
  mark_ = until;
}

// Ends the slice of the running job; the job itself stays where it is.
void Preemptive::leave_processor() noexcept {
  if (!running_.is_valid()) return;
  if (mark_ > slice_start_) {
    releases_.tap().record(TapKind::kRun, slice_start_, running_, CHIMERA_CYCLE, (mark_ - slice_start_).count);
  }
  slice_start_ = mark_;
}

void Preemptive::complete() noexcept {
  if (!running_.is_valid() || active_[running_.index].remaining > Nanoseconds{}) return;
  leave_processor();
  Active& a = active_[running_.index];
  running_ = TaskId();
  end(a, mark_);
}

void Preemptive::end(Active& a, Nanoseconds now) noexcept {
  a.has_begun = false;
  if (a.is_demoted) (void)std::remove(demoted_.begin(), demoted_.begin() + n_demoted_--, a.job.task);
  a.is_demoted = false;
  releases_.queue().finish(a.job.task);
  if (!sporadic_.empty()) finish_event(a.job.task);
  releases_.end_job(sporadic_.empty() ? a.job : without_server(a.job), a.time, a.body, a.first_start, now, a.used);
}

void Preemptive::expire(Nanoseconds now) noexcept {
  if (next_deadline() > now) return;
  for (const std::uint32_t i : abandoners_) {
    if (active_[i].next_deadline > now) continue;
    expire(TaskId(i));
    if (active_[i].next_deadline != kNever) active_[i].next_deadline += tasks_[i].period;
  }
}

// The deadline of the task's present job has come; if it is unfinished it is over.
void Preemptive::expire(TaskId task) noexcept {
  Active& a = active_[task.index];
  const Nanoseconds deadline = a.next_deadline;
  Job waiting;
  if (!a.has_begun) {
    if (releases_.queue().remove(task, waiting)) releases_.misses().expire_unstarted(waiting);
    return;
  }
  if (a.job.deadline != deadline) return;
  if (running_ == task) {
    leave_processor();
    running_ = TaskId();
  } else {
    (void)releases_.queue().remove(task, waiting);
  }
  releases_.misses().abandon(a.job);
  if (!a.body.is_partial) a.body.answer = Answer::kAborted;
  end(a, deadline);
}

// What is over at this instant has ended by now: these need more.
void Preemptive::demote_due(Nanoseconds now) noexcept {
  if (running_.is_valid() && budget_left(running_) == Nanoseconds{}) {
    const Active& a = active_[running_.index];
    (void)releases_.misses().report_overrun(running_, releases_.task(running_).call.cycle, a.used, now);
    demote(running_);
  }
  for (const std::uint32_t i : demoters_) {
    const Active& a = active_[i];
    if (a.has_begun && !a.is_demoted && a.job.deadline <= now) demote(TaskId(i));
  }
}

void Preemptive::demote(TaskId task) noexcept {
  Job job;
  if (running_ == task) {
    leave_processor();
    running_ = TaskId();
  } else {
    (void)releases_.queue().remove(task, job);
  }
  active_[task.index].is_demoted = true;
  demoted_[static_cast<std::size_t>(n_demoted_++)] = task;
  ++releases_.task(task).profile.demoted;
}

void Preemptive::run_edge(Nanoseconds& now) noexcept {
  clock_.set(now);
  releases_.take_edge(now);
  if (clock_.spent() == Nanoseconds{}) return;
  leave_processor();  // methods at an edge hold the processor
  now += clock_.spent();
  mark_ = slice_start_ = now;
}

// Nothing can happen before `end`: a job that begins now and ends then needs no look in between.
bool Preemptive::runs_through(Nanoseconds end) const noexcept {
  return !by_laxity_ && !has_exceptions() && !releases_.must_look(end - Nanoseconds{1});
}

// Gives the processor to the most urgent job. True when that job has ended at `now`: it needed no time, or nothing
// happened until its end. The instant is not over, for it may have sent signals.
bool Preemptive::dispatch(Nanoseconds& now) noexcept {
  ReadyQueue& queue = releases_.queue();
  while (!queue.is_empty()) {
    if (running_.is_valid()) {
      if (!must_yield()) return false;
      preempt(now);
    }
    if (!run_job(queue.pop(), now)) continue;
    if (const Nanoseconds end = now + active_[running_.index].remaining; runs_through(end)) {
      now = end;
      use_processor(end);
    }
    complete();
    if (!running_.is_valid()) return true;
    if (!by_laxity_) return false;  // it was the most urgent one
  }
  if (!running_.is_valid() && n_demoted_ > 0) {
    running_ = demoted_[0];
    slice_start_ = mark_ = now;
  }
  return false;
}

void Preemptive::preempt(Nanoseconds now) noexcept {
  const Active& a = active_[running_.index];
  leave_processor();
  if (!a.is_demoted) {
    releases_.tap().record(TapKind::kPreempt, now, running_, 0);
    ++releases_.task(running_).profile.preempted;
    releases_.queue().put_back(a.job, a.remaining);
  }
  running_ = TaskId();
}

bool Preemptive::must_yield() noexcept {
  const Active& a = active_[running_.index];
  if (a.is_demoted) return true;
  const TaskSpec& spec = tasks_[running_.index];
  const Urgency mine{spec.criticality, spec.user_priority, spec.period, a.job.deadline, a.remaining};
  return is_more_urgent(releases_.queue().policy(), releases_.queue().top_urgency(), mine);
}

bool Preemptive::run_job(const Job& job, Nanoseconds now) noexcept {
  Active& a = active_[job.task.index];
  if (!a.has_begun) {
    const Job own = sporadic_.empty() ? job : without_server(job);
    if (!releases_.may_start(own, now)) {
      finish_event(job.task);
      return false;
    }
    clock_.set(now);
    a.job = job;
    a.body = releases_.jobs().open_and_begin(own, a.time, releases_.is_illegal());
    a.first_start = now;
    a.used = Nanoseconds{};
    const bool had_event = a.body.answer != Answer::kNoEvent;
    Task& task = releases_.task(job.task);
    if (task.background != nullptr && had_event) run_background(task, Method::kCycle, now);
    a.remaining = modelled_time(tasks_[job.task.index], job.task, job.release - releases_.origin(), clock_.spent(),
                                had_event, options_.seed ? &*options_.seed : nullptr);
    a.has_begun = true;
    releases_.queue().occupy(job.task);
  }
  a.job.deadline = job.deadline;
  running_ = job.task;
  slice_start_ = mark_ = now;
  return true;
}

}  // namespace chimera
