// SPDX-License-Identifier: Apache-2.0
// Begins and ends the jobs of a non-preemptive processor in virtual time.
#include "chimera/runtime/virtual/stepped_executive.h"

#include <algorithm>

namespace chimera {

void SteppedExecutive::end_due(Nanoseconds now) noexcept {
  if (!has_job_ || end_ > now) return;
  has_job_ = false;
  clock_.set(end_);
  releases_.tap().record(TapKind::kRun, start_, job_.task, CHIMERA_CYCLE, (end_ - start_).count);
  releases_.end_job(job_, time_, body_, start_, end_, end_ - start_);
  clock_.set(clock_.now());  // the method error took its time
  hold_until(clock_.now());
}

// The time of an error method, for a job that was not started at this instant, counts for the next action.
void SteppedExecutive::stand_at(Nanoseconds now) noexcept {
  if (clock_.now() - clock_.spent() != now) clock_.set(now);
}

Nanoseconds SteppedExecutive::edge(Nanoseconds now) noexcept {
  stand_at(now);
  releases_.take_edge(now);
  clock_.set(clock_.now());
  return clock_.now();
}

bool SteppedExecutive::begin_job(Nanoseconds now) noexcept {
  if (releases_.queue().is_empty()) return false;
  stand_at(now);
  job_ = releases_.queue().pop();
  if (!releases_.may_start(job_, now)) return true;
  body_ = releases_.jobs().open_and_begin(job_, time_, releases_.is_illegal());
  const bool had_event = body_.answer != Answer::kNoEvent;
  Task& task = releases_.task(job_.task);
  if (task.background != nullptr && had_event) run_background(task, Method::kCycle, now);
  start_ = now;
  end_ = now + modelled_time(*task.spec, job_.task, job_.release - releases_.origin(), clock_.spent(), had_event,
                             times_ ? &*times_ : nullptr);
  has_job_ = true;
  return end_ == now;
}

Nanoseconds SteppedExecutive::next_own(Nanoseconds now) noexcept {
  if (has_job_) return end_;
  return releases_.queue().is_empty() ? releases_.next_event() : now;
}

Nanoseconds SteppedExecutive::finish(Nanoseconds now) noexcept {
  if (!has_job_) return now;
  end_due(end_);
  return std::max(now, clock_.now());
}

void SteppedExecutive::cut(Nanoseconds now) noexcept {
  if (has_job_) releases_.tap().record(TapKind::kRun, start_, job_.task, CHIMERA_CYCLE, (now - start_).count);
}

}  // namespace chimera
