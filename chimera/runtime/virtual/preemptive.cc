// SPDX-License-Identifier: Apache-2.0
// Simulates preemptive scheduling event by event: releases, completions, deadlines, budgets and servers.
#include "chimera/runtime/virtual/preemptive.h"

#include <algorithm>

namespace chimera {

Preemptive::Preemptive(Releases& releases, std::span<const TaskSpec> tasks, ModelledClock& clock,
                       const PreemptiveOptions& options)
    : releases_(releases), tasks_(tasks), clock_(clock), options_(options),
      processor_(releases.tap(), tasks.size()), sporadic_(releases, tasks, processor_), demoted_(tasks.size()) {
  const Policy policy = releases.queue().classes().policy();
  by_laxity_ = policy == Policy::kLlf || policy == Policy::kMufLaxity;
  for (std::uint32_t i = 0; i < tasks.size(); ++i) {
    if (!tasks[i].server && tasks[i].on_miss == OnMiss::kAbort) abandoners_.push_back({TaskId(i)});
    if (tasks[i].on_miss == OnMiss::kDemote) demoters_.push_back(TaskId(i));
    if (tasks[i].on_miss == OnMiss::kDemote || tasks[i].on_overrun == OnMiss::kDemote) has_demotion_ = true;
  }
}

// Gives the processor to the most urgent job. True when that job has ended at `now`: it needed no time, or nothing
// happened until its end. The instant is not over, for it may have sent signals.
template <Preemptive::Ends kEnds>
bool Preemptive::dispatch(Nanoseconds& now) noexcept {
  ReadyQueue& queue = releases_.queue();
  while (!queue.is_empty()) {
    if (!processor_.is_idle()) {
      if (!must_yield()) return false;
      preempt(now);
    }
    if (!run_job(queue.pop(), now)) continue;
    const Nanoseconds end = now + processor_.job().remaining;
    if (kEnds == Ends::kElsewhere) {
      if (end == now) return true;
    } else {
      if (runs_through(end)) {
        now = end;
        use_processor(end);
      }
      complete();
      if (processor_.is_idle()) return true;
    }
    if (!by_laxity_) return false;  // it was the most urgent one
  }
  if (processor_.is_idle() && n_demoted_ > 0) processor_.give(demoted_[0], now);
  return false;
}

[[gnu::always_inline]] inline void Preemptive::end_all_due(Nanoseconds now) noexcept {
  use_processor(now);
  complete();
  if (!abandoners_.empty()) expire(now);
  if (has_demotion_) demote_due(now);
}

RunEnd Preemptive::run(Nanoseconds& now, Nanoseconds until) noexcept {
  sporadic_.open();
  releases_.look_again();
  for (;;) {
    end_all_due(now);
    if (releases_.must_look(now)) {
      if (releases_.stop_requested()) return RunEnd::kStopped;
      if (releases_.settlement().task_stopped()) return RunEnd::kTaskStopped;
      if (now >= until) {
        processor_.record_slice();
        return RunEnd::kTime;
      }
      if (releases_.edge_is_due(now)) run_edge(now);
      releases_.release_due(now);
      releases_.rest(until);
    }
    follow_servers(now);
    if (dispatch<Ends::kHere>(now)) continue;
    if (is_idle() && !releases_.anything_left()) return RunEnd::kNothingLeft;
    now = std::clamp(next_event(now), now, until);
  }
}

void Preemptive::end_due(Nanoseconds now) noexcept {
  sporadic_.open();
  end_all_due(now);
}

void Preemptive::record_slice(Nanoseconds now) noexcept {
  use_processor(now);
  processor_.record_slice();
}

Nanoseconds Preemptive::next_event(Nanoseconds now) noexcept {
  Nanoseconds next = releases_.next_event();
  if (has_exceptions()) next = std::min(next, next_exception(now));
  if (processor_.is_idle()) return next;
  next = std::min(next, now + processor_.job().remaining);
  if (!by_laxity_ || releases_.queue().is_empty()) return next;
  const Nanoseconds since = now - releases_.origin();
  return std::min(next, releases_.origin() + options_.quantum * (since / options_.quantum + 1));
}

// The next instant that only tasks with the reactions abort and demote, and tasks behind servers, have.
Nanoseconds Preemptive::next_exception(Nanoseconds now) noexcept {
  return std::min({next_deadline(), next_demotion(now), sporadic_.next_change(now)});
}

// Deadlines lie on the grid of releases, so they are known without looking at any job.
Nanoseconds Preemptive::next_deadline() noexcept {
  Nanoseconds next = kNever;
  for (Abandoner& a : abandoners_) {
    if (!releases_.members().is_on(a.task)) a.next_deadline = kNever;
    else if (a.next_deadline == kNever)
      a.next_deadline = releases_.queue().classes().first_release(a.task.index) + tasks_[a.task.index].deadline;
    next = std::min(next, a.next_deadline);
  }
  return next;
}

Nanoseconds Preemptive::next_demotion(Nanoseconds now) noexcept {
  Nanoseconds next = kNever;
  for (const TaskId task : demoters_)
    if (const BegunJob& a = processor_.of(task); a.has_begun && !a.is_demoted) next = std::min(next, a.job.deadline);
  if (processor_.is_idle()) return next;
  const Nanoseconds left = budget_left(processor_.running());
  return left == kNever ? next : std::min(next, now + left);
}

// Of the task's job that has begun, where its end is a demotion; else kNever.
Nanoseconds Preemptive::budget_left(TaskId task) const noexcept {
  const TaskSpec& spec = tasks_[task.index];
  const BegunJob& a = processor_.of(task);
  const bool counts = spec.on_overrun == OnMiss::kDemote && spec.budget > Nanoseconds{} && !a.is_demoted;
  return counts ? std::max(spec.budget - a.used, Nanoseconds{}) : kNever;
}

void Preemptive::use_processor(Nanoseconds until) noexcept {
  if (processor_.is_idle()) return;
  const Nanoseconds used = processor_.use(until);
  if (!sporadic_.are_none()) sporadic_.charge(processor_.running(), used);
}

void Preemptive::complete() noexcept {
  if (processor_.is_idle() || processor_.job().remaining > Nanoseconds{}) return;
  BegunJob& a = processor_.job();
  processor_.take();
  end(a, processor_.counted_until());
}

void Preemptive::end(BegunJob& a, Nanoseconds now) noexcept {
  a.has_begun = false;
  if (a.is_demoted) (void)std::remove(demoted_.begin(), demoted_.begin() + n_demoted_--, a.job.task);
  a.is_demoted = false;
  releases_.queue().finish(a.job.task);
  if (!sporadic_.are_none()) sporadic_.finish(a.job.task);
  const Job own = sporadic_.are_none() ? a.job : sporadic_.without_server(a.job);
  releases_.end_job(own, a.time, a.body, a.first_start, now, a.used);
}

void Preemptive::expire(Nanoseconds now) noexcept {
  if (next_deadline() > now) return;
  for (Abandoner& a : abandoners_) {
    if (a.next_deadline > now) continue;
    expire(a.task, a.next_deadline);
    if (a.next_deadline != kNever) a.next_deadline += tasks_[a.task.index].period;
  }
}

// The deadline of the task's present job has come; if it is unfinished it is over.
void Preemptive::expire(TaskId task, Nanoseconds deadline) noexcept {
  BegunJob& a = processor_.of(task);
  Job waiting;
  if (!a.has_begun) {
    if (releases_.queue().remove(task, waiting)) releases_.misses().expire_unstarted(waiting);
    return;
  }
  if (a.job.deadline != deadline) return;
  if (processor_.running() == task) {
    processor_.take();
  } else {
    (void)releases_.queue().remove(task, waiting);
  }
  releases_.misses().abandon(a.job);
  if (!a.body.is_partial) a.body.answer = Answer::kAborted;
  end(a, deadline);
}

// Jobs that are over at this instant have ended already: these need more time.
void Preemptive::demote_due(Nanoseconds now) noexcept {
  if (const TaskId task = processor_.running(); task.is_valid() && budget_left(task) == Nanoseconds{}) {
    (void)releases_.misses().report_overrun(task, releases_.task(task).call.cycle, processor_.job().used, now);
    demote(task);
  }
  for (const TaskId task : demoters_) {
    const BegunJob& a = processor_.of(task);
    if (a.has_begun && !a.is_demoted && a.job.deadline <= now) demote(task);
  }
}

void Preemptive::demote(TaskId task) noexcept {
  Job job;
  if (processor_.running() == task) {
    processor_.take();
  } else {
    (void)releases_.queue().remove(task, job);
  }
  processor_.of(task).is_demoted = true;
  demoted_[static_cast<std::size_t>(n_demoted_++)] = task;
  ++releases_.task(task).profile.demoted;
}

void Preemptive::run_edge(Nanoseconds& now) noexcept {
  clock_.set(now);
  releases_.take_edge(now);
  if (clock_.spent() == Nanoseconds{}) return;
  processor_.record_slice();  // methods at a cycle boundary hold the processor
  now += clock_.spent();
  processor_.resume(now);
}

// Nothing can happen before `end`: a job that begins now and ends then needs no look in between.
bool Preemptive::runs_through(Nanoseconds end) const noexcept {
  return !by_laxity_ && !has_exceptions() && !releases_.must_look(end - Nanoseconds{1});
}

bool Preemptive::dispatch_by_step(Nanoseconds now) noexcept { return dispatch<Ends::kElsewhere>(now); }

void Preemptive::preempt(Nanoseconds now) noexcept {
  const TaskId task = processor_.running();
  const BegunJob& a = processor_.job();
  processor_.take();
  if (!a.is_demoted) {
    releases_.tap().record(TapKind::kPreempt, now, task, 0);
    ++releases_.task(task).profile.preempted;
    releases_.queue().put_back(a.job, a.remaining);
  }
}

bool Preemptive::must_yield() noexcept {
  const BegunJob& a = processor_.job();
  if (a.is_demoted) return true;
  const TaskSpec& spec = tasks_[a.job.task.index];
  const Urgency mine{spec.criticality, spec.user_priority, spec.period, a.job.deadline, a.remaining};
  return is_more_urgent(releases_.queue().classes().policy(), releases_.queue().top_urgency(), mine);
}

bool Preemptive::run_job(const Job& job, Nanoseconds now) noexcept {
  BegunJob& a = processor_.of(job.task);
  if (!a.has_begun) {
    const Job own = sporadic_.are_none() ? job : sporadic_.without_server(job);
    if (!releases_.may_start(own, now)) {
      sporadic_.finish(job.task);
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
                                had_event, options_.times ? &*options_.times : nullptr);
    a.has_begun = true;
    releases_.queue().occupy(job.task);
  }
  a.job.deadline = job.deadline;
  processor_.give(job.task, now);
  return true;
}

}  // namespace chimera
