// SPDX-License-Identifier: Apache-2.0
// One processor in virtual time: the jobs that have begun on it, which of them has it, and what each has used.
// preemptive.h decides which job gets the processor.
#pragma once

#include <cstddef>
#include <vector>

#include "chimera/runtime/job/job_step.h"
#include "chimera/runtime/record/context_tap.h"

namespace chimera {

/// The present job of one task, which has begun unless said otherwise.
struct BegunJob {
  Job job;
  CycleTime time;
  BodyEnd body;
  Nanoseconds first_start, used, remaining;
  bool has_begun = false;   ///< and not ended
  bool is_demoted = false;  ///< runs when no other job is ready
};

/// Context: cycle; no allocation; one thread at a time.
class VirtualProcessor {
 public:
  /// Slices are recorded there; the tap outlives this. Context: setup.
  VirtualProcessor(ContextTap& tap, std::size_t n_tasks) : tap_(tap), jobs_(n_tasks) {}

  BegunJob& of(TaskId task) noexcept { return jobs_[task.index]; }
  const BegunJob& of(TaskId task) const noexcept { return jobs_[task.index]; }

  bool is_idle() const noexcept { return !running_.is_valid(); }
  /// Invalid when idle.
  TaskId running() const noexcept { return running_; }
  /// The job that has the processor. Requires: not idle.
  BegunJob& job() noexcept { return jobs_[running_.index]; }
  const BegunJob& job() const noexcept { return jobs_[running_.index]; }

  /// The job of the task begins a slice at `now`. Requires: idle.
  void give(TaskId task, Nanoseconds now) noexcept {
    running_ = task;
    slice_start_ = mark_ = now;
  }
  /// The job uses the processor up to `until`; answers how long that is since the last call. Requires: not idle.
  Nanoseconds use(Nanoseconds until) noexcept {
    const Nanoseconds time = until - mark_;
    BegunJob& a = job();
    a.used += time;
    a.remaining -= time;
    mark_ = until;
    return time;
  }
  /// Up to where the time of the job that ran last is counted.
  Nanoseconds counted_until() const noexcept { return mark_; }
  /// The slice is recorded as far as it is counted, and goes on. No effect when idle.
  void record_slice() noexcept {
    if (is_idle()) return;
    if (mark_ > slice_start_) {
      tap_.record(TapKind::kRun, slice_start_, running_, CHIMERA_CYCLE, (mark_ - slice_start_).count);
    }
    slice_start_ = mark_;
  }
  /// Something else had the processor until `now`: the slice goes on there. Requires: record_slice().
  void resume(Nanoseconds now) noexcept { slice_start_ = mark_ = now; }
  /// The job leaves the processor; its slice is recorded. No effect when idle.
  void take() noexcept {
    record_slice();
    running_ = TaskId();
  }

 private:
  ContextTap& tap_;
  std::vector<BegunJob> jobs_;  // one per task
  TaskId running_;
  Nanoseconds slice_start_, mark_;
};

}  // namespace chimera
