// SPDX-License-Identifier: Apache-2.0
// The non-preemptive loop (2000 paper, figure 11): signals at the cycle boundary, releases, the most urgent job,
// again.
// One loop for real and for virtual time; `Time` says what the clock shows and how long a job took.
#pragma once

#include "chimera/runtime/cycle/releases.h"

namespace chimera {

/// Runs until the clock shows `until`; a job under way then is finished. `Time` has
///   Nanoseconds now()                                   the clock
///   void wait_until(Nanoseconds)                        may end early
///   Nanoseconds end_of(const Job&, BodyEnd, Nanoseconds start)   the body has run: when does the job end?
///   Nanoseconds after(Nanoseconds end)                  the job's end is dealt with: when does the next begin?
/// In a row of jobs the end of one is the start of the next, so real time costs one clock read a job.
/// Context: cycle; no allocation, no lock, no system call but what Time does.
template <class Time>
RunEnd run_cycles(Releases& releases, Time& time, Nanoseconds until) noexcept {
  ReadyQueue& queue = releases.queue();
  releases.look_again();
  for (Nanoseconds now = time.now();;) {
    if (releases.must_look(now)) {
      if (releases.stop_requested()) return RunEnd::kStopped;
      if (releases.settlement().task_stopped()) return RunEnd::kTaskStopped;
      if (now >= until) return RunEnd::kTime;
      if (releases.edge_is_due(now)) {
        releases.take_edge(now, true);
        now = time.now();  // methods took their time
      }
      releases.release_due(now);
      releases.rest(until);
    }
    if (queue.is_empty()) {
      if (!releases.anything_left()) return RunEnd::kNothingLeft;
      const Nanoseconds next = releases.next_event();
      time.wait_until(next < until ? next : until);
      now = time.now();
      continue;
    }
    const Job job = queue.pop();
    if (!releases.may_start(job, now)) continue;
    CycleTime cycle;
    const BodyEnd body = releases.jobs().open_and_begin(job, cycle, releases.is_illegal());
    const Nanoseconds end = time.end_of(job, body, now);
    if (releases.tap().is_on()) releases.tap().record(TapKind::kRun, now, job.task, CHIMERA_CYCLE, (end - now).count);
    releases.end_job(job, cycle, body, now, end, end - now);
    now = time.after(end);
  }
}

}  // namespace chimera
