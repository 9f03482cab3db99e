// SPDX-License-Identifier: Apache-2.0
// The supervisor of a preemptive context: a thread at the ceiling that one alarm wakes to check jobs that are late, use
// too much, never end, or run out of the capacity of their server.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "chimera/runtime/preemptive/processor.h"

namespace chimera {

/// In the section, unless said otherwise. Context: cycle; wait-free but for system calls that read the execution time
/// of a thread, change a level or move the alarm.
class Supervisor {
 public:
  /// The references outlive it. Context: setup.
  Supervisor(Releases& releases, ReadyJobs& ready, ProcessorShare& share, JobChecks& checks, Processor& processor,
             JobClock& clock);

  /// Checks jobs in a thread of its own until quit(); that thread adds one to `n_attached` when it is at the ceiling.
  /// Context: setup; outside the section; may block.
  void start(std::atomic<std::size_t>& n_attached);
  /// No check after this one. Context: setup.
  void quit() noexcept;
  /// Context: setup; outside the section; blocks until the thread has ended.
  void join() { thread_.join(); }

  /// Called by the thread when the alarm rings: checks every job that is due, and sets the alarm for the next one.
  void check_jobs(Nanoseconds now) noexcept;
  /// Call before others are released: charges the job that has the processor with the time it used, and acts on that.
  void check_running(Nanoseconds now) noexcept;
  /// A job that has just been inserted is checked from here on.
  void watch_released(JobThread& job, Nanoseconds now) noexcept;
  /// The job is over: forgets all observations of it.
  void forget(const JobThread& job) noexcept;
  /// If little is left of the processor's share, demotes one job; never the job of `own`, the caller in the section
  /// (null: the supervisor).
  void keep_share(Nanoseconds now, const JobThread* own) noexcept;
  /// True, once, if the job does not end by itself, or its thread is gone: the caller reports that.
  bool pop_hanging(const JobThread& job) noexcept;

 private:
  /// Observations of the present job of a task.
  struct Seen {
    Nanoseconds used, at;         // at the last look, and when that was
    Nanoseconds slept;            // for how long it has used nothing though it could
    bool is_given_up = false;     // it does not end by itself
    bool is_unreported = false;   // and that is not reported yet
  };

  void run(std::atomic<std::size_t>& n_attached) noexcept;
  void check(JobThread& job, Nanoseconds now) noexcept;
  void check_claimed(JobThread& job, Nanoseconds now) noexcept;
  void follow_release(JobThread& job, Nanoseconds now) noexcept;
  void check_begun(JobThread& job, Nanoseconds now) noexcept;
  void charge(JobThread& job, Nanoseconds now) noexcept;
  void overrun(JobThread& job, Nanoseconds now) noexcept;
  void report_late(const JobThread& job, bool has_begun) noexcept;
  Nanoseconds slept(const JobThread& job, Nanoseconds used, Nanoseconds now) noexcept;
  void give_up(JobThread& job, Nanoseconds used, Nanoseconds now) noexcept;
  void reap(JobThread& job, Nanoseconds now) noexcept;
  void follow_server(JobThread& job, Nanoseconds now) noexcept;
  Nanoseconds next_late(Nanoseconds now) const noexcept;
  void demote_for_share(JobThread& job, Nanoseconds now) noexcept;
  Seen& seen(const JobThread& job) noexcept { return seen_[job.id.index]; }

  Releases& releases_;
  ReadyJobs& ready_;
  ProcessorShare& share_;
  JobChecks& checks_;
  Processor& processor_;
  JobClock& clock_;
  std::vector<Seen> seen_;  // by task
  std::thread thread_;
  std::atomic<bool> quits_{false};  // written in the section, where run() looks again: pairs with Section
};

}  // namespace chimera
