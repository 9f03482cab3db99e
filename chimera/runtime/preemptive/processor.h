// SPDX-License-Identifier: Apache-2.0
// Data that all threads of a preemptive context share: the section, and the job that has the processor.
//
// Every thread that enters the section runs at the ceiling, on one CPU, and neither blocks nor faults in it, so the
// kernel's own order excludes; the lock behind it is for threads without real-time rights. A job lowers itself to its
// label as the last thing of the section: the order of labels is the order of urgency and the kernel dispatches.
// docs/design/preemptive.md
#pragma once

#include <algorithm>

#include "chimera/platform/wake.h"
#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/preemptive/job_checks.h"
#include "chimera/runtime/preemptive/processor_share.h"
#include "chimera/runtime/preemptive/ready_jobs.h"

namespace chimera {

/// In the section, unless said otherwise. Context: cycle; wait-free but for system calls that change a level or move
/// the alarm.
class Processor {
 public:
  /// The references outlive it. Context: setup.
  Processor(TaskSet& set, Releases& releases, ReadyJobs& ready, ProcessorShare& share, JobChecks& checks,
            const ProcessorPlace& place);

  /// Context: cycle; outside the section, by a thread at the ceiling; waits only without real-time levels.
  void enter() noexcept {
    section_.enter();
    if (place_.checks) check();
  }
  void leave() noexcept {
    if (place_.checks) check_holder();
    section_.leave();
  }

  /// After the ready list changed: the most urgent job has the processor from here on, and its checks follow.
  void dispatch(Nanoseconds now) noexcept;
  /// The most urgent job, at the last dispatch; null: none was ready.
  const JobThread* on_processor() const noexcept { return on_processor_; }
  /// From here on the job runs below all others.
  void demote(JobThread& job, Nanoseconds now) noexcept;
  /// The job, which is claimed, never begins; its thread comes to the ceiling and notices.
  void cancel(JobThread& job, Nanoseconds now) noexcept;
  /// The job had the processor up to `now`, as far as can be told.
  void record_slice(const JobThread& job, Nanoseconds now) noexcept;
  /// Shows which job runs, for processes that ask about this one, also after its death.
  void show_running() noexcept;

  /// When a job that has the processor will have used up its budget: JobChecks::end_of_budget().
  Nanoseconds end_of_budget(const JobThread& job, Nanoseconds now) noexcept;
  /// When the server of the job has something new to say of it, or its capacity or budget will be used up.
  Nanoseconds next_server_check(JobThread& job, Nanoseconds now) noexcept;
  /// When the laxity policy compares jobs again.
  Nanoseconds next_quantum(Nanoseconds now) const noexcept;

  /// No job begins.
  bool is_paused() const noexcept { return is_paused_; }
  void pause() noexcept { is_paused_ = true; }
  void go_on() noexcept { is_paused_ = false; }
  /// The bell on which run() sleeps: a ring asks for a cycle boundary. Context: any; wait-free.
  Doorbell edge_bell() const noexcept { return Doorbell(*bell_); }
  /// Written by the parts that count. Section and levels are in seen() alone.
  ProcessorCounts& counts() noexcept { return counts_; }
  /// Context: between runs.
  ProcessorCounts seen() const noexcept;

 private:
  void note_preempted(const JobThread& job, Nanoseconds now) noexcept;
  void check() noexcept;
  void check_holder() noexcept;

  std::span<Task> tasks_;
  Releases& releases_;
  ReadyJobs& ready_;
  ProcessorShare& share_;
  JobChecks& checks_;
  ProcessorPlace place_;
  Section section_;
  JobThread* on_processor_ = nullptr;
  bool is_paused_ = true;
  std::atomic<std::uint32_t> own_bell_{0};  // pairs with itself: Doorbell::ring() and read()
  std::atomic<std::uint32_t>* bell_;        // that word, or the one of ProcessorPlace
  ProcessorCounts counts_;
  std::uint64_t taken_before_ = 0, sleeps_before_ = 0;  // with checks: when the section was entered
};

}  // namespace chimera
