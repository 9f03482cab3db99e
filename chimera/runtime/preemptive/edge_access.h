// SPDX-License-Identifier: Apache-2.0
// Access of the cycle boundary to the tasks of a preemptive context, whose jobs have threads of their own: which tasks
// it may touch, facts about jobs that are under way, and calls of methods at the label of their task.
#pragma once

#include <vector>

#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/preemptive/processor.h"

namespace chimera {

/// In the section, by the thread of the cycle boundaries, unless said otherwise. Context: cycle boundary; wait-free.
class EdgeAccess final : public JobThreads {
 public:
  /// The references are used from attach() on and outlive it. Context: setup.
  EdgeAccess(Releases& releases, ReadyJobs& ready, Processor& processor, JobClock& clock, std::size_t n_tasks);

  /// The calling thread handles the cycle boundaries from here on. Context: setup; outside the section.
  void attach() noexcept;

  bool claim(TaskId task) noexcept override;
  Nanoseconds used_by_job(TaskId task) noexcept override;
  /// Result of look_up_blocked().
  bool is_blocked(TaskId task) noexcept override;
  /// The method runs outside the section, at the label of the task. Before attach(), and for a task with a job under
  /// way, it runs in the section.
  Answer call(Task& task, Method method, Nanoseconds now) noexcept override;

  bool run_beside_methods() const noexcept override { return true; }
  bool preempt() const noexcept override { return true; }
  Nanoseconds latest_release() const noexcept override;
  bool has_job_before(TaskId task, Nanoseconds at) const noexcept override;
  void await_job(TaskId task) noexcept override;
  void hold_releases(Nanoseconds from) noexcept override;
  void let_release(TaskId task) noexcept override;
  Nanoseconds next_look(Nanoseconds now) const noexcept override { return now + kLook; }

  /// Releases before `until` are taken; all threads check their tasks.
  void open(Nanoseconds until) noexcept;
  /// Threads follow the states of their tasks. Threads without news sleep on.
  void follow_all() noexcept;

  /// Collects the begun jobs that the cycle boundary at `now` reports as late and that are not looked up yet. True if
  /// there are some: look_up_blocked() is due.
  bool collect_late(Nanoseconds now) noexcept;
  /// Finds out which of the collected jobs sleep in a system call. Context: cycle boundary; outside the section; may
  /// block for some microseconds a job, in which others act.
  void look_up_blocked() noexcept;
  /// The cycle boundary has reported the missed deadlines.
  void forget_blocked() noexcept;

 private:
  /// State of the look-up for the late job of a task.
  struct LookUp {
    bool is_due = false, is_done = false, is_blocked = false;
  };

  // The end of an awaited job asks for a cycle boundary; this time is for a job that never ends.
  static constexpr Nanoseconds kLook = milliseconds(1);

  void follow(JobThread& job, bool is_new) noexcept;
  JobThread* leave_for(TaskId task) noexcept;
  void return_from(JobThread& job) noexcept;

  Releases& releases_;
  ReadyJobs& ready_;
  Processor& processor_;
  JobClock& clock_;
  std::vector<LookUp> look_ups_;  // by task
  pid_t thread_ = 0;              // 0: no thread handles cycle boundaries yet
  Nanoseconds end_ = kNever;      // of the run
};

}  // namespace chimera
