// SPDX-License-Identifier: Apache-2.0
// The loop of every task's thread: it sleeps at the ceiling until a release, runs the job at its label, and raises
// itself to report the end of the job.
//
//   sleep | [next release, label] | body at the label | raise | [end]          [...]: in the section
#pragma once

#include "chimera/runtime/preemptive/supervisor.h"
#include "chimera/runtime/preemptive/thread_clock.h"

namespace chimera {

/// One for all threads of a context. Context: cycle; in the section, by the thread of the task; unless said otherwise.
class JobLoop {
 public:
  /// A null listener: profiles are not shown. The references outlive it. Context: setup.
  JobLoop(TaskSet& set, Releases& releases, ReadyJobs& ready, JobChecks& checks, Processor& processor,
          Supervisor& supervisor, ThreadClock& clock, BoundaryListener* guest);

  /// The life of the thread of `me`, until quit(). Adds one to `n_attached` when the thread is at the ceiling.
  /// Context: the thread of the task; outside the section; blocks.
  void run(JobThread& me, std::atomic<std::size_t>& n_attached);
  /// Threads that wake end. Context: setup; in the section.
  void quit() noexcept { quits_ = true; }
  /// Shows the profile of the task, which no job is writing. Context: cycle boundary too.
  void show(JobThread& job, Nanoseconds now) noexcept;

 private:
  void accept_event(JobThread& me, Nanoseconds now) noexcept;
  bool listens(const JobThread& me) const noexcept;
  void wait(JobThread& me, std::uint32_t heard, Nanoseconds until) noexcept;
  void run_job(JobThread& me, Nanoseconds now) noexcept;
  bool accept_release(JobThread& me, Nanoseconds now) noexcept;
  void prepare(JobThread& me, const Job& job) noexcept;
  int make_ready(JobThread& me, Nanoseconds now) noexcept;
  bool begin(JobThread& me) noexcept;
  Nanoseconds run_body(JobThread& me) noexcept;
  void end(JobThread& me, Nanoseconds now) noexcept;

  TaskSet& set_;
  Releases& releases_;
  ReadyJobs& ready_;
  JobChecks& checks_;
  Processor& processor_;
  Supervisor& supervisor_;
  ThreadClock& clock_;
  BoundaryListener* guest_;
  const bool sees_switches_;
  bool quits_ = false;
};

}  // namespace chimera
