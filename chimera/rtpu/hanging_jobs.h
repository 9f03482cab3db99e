// SPDX-License-Identifier: Apache-2.0
// Jobs that do not end: a cycle boundary notes them, and the supervising thread reads them and ends the rtpu.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/platform/wake.h"
#include "chimera/runtime/task_word.h"

namespace chimera {

class HangingJobs {
 public:
  explicit HangingJobs(std::size_t n_tasks) : is_hanging_(n_tasks) {}
  /// Event descriptor that wake_supervisor() writes to. Context: setup.
  void set_supervisor(int descriptor) noexcept { supervisor_ = descriptor; }

  /// `age`: time since the release of the job; zero: the thread of the job is gone. `used`: its execution time, if it
  /// used too much. Context: cycle boundary.
  void note(TaskWord job, Nanoseconds age, Nanoseconds used) noexcept {
    is_hanging_[job.task().index] = true;
    age_ = age.count;
    used_ = used.count;
    job_ = job.word();
    any_ = true;
    wake_supervisor();
  }
  /// True if the job of the task hangs: the rtpu does not wait for it. Context: cycle boundary.
  bool has(TaskId task) const noexcept { return is_hanging_[task.index]; }
  void wake_supervisor() const noexcept {
    if (supervisor_ >= 0) ring_event(supervisor_);
  }

  // Context of the rest: any thread; wait-free.
  bool any() const noexcept { return any_; }
  /// The last noted job, as BlockHead::running, its age at that time, and what it used. Requires: any().
  std::uint32_t job() const noexcept { return job_; }
  Nanoseconds age() const noexcept { return {age_}; }
  Nanoseconds used() const noexcept { return {used_}; }

 private:
  std::vector<bool> is_hanging_;  // by task
  int supervisor_ = -1;
  // A cycle boundary calls note(), the main thread reads. any_ is stored last and loaded first, so that the other
  // members are seen.
  std::atomic<bool> any_{false};
  std::atomic<std::uint32_t> job_{0};
  std::atomic<std::int64_t> age_{0}, used_{0};
};

}  // namespace chimera
