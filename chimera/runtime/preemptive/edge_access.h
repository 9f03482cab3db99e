// SPDX-License-Identifier: Apache-2.0
// How the edge of a preemptive context touches tasks whose jobs have threads of their own: what it may touch, what it
// learns of jobs that are under way, and how it runs a method of a task at the label of that task.
#pragma once

#include <vector>

#include "chimera/runtime/job_threads.h"
#include "chimera/runtime/preemptive/processor.h"

namespace chimera {

/// In the section, by the thread that takes the edges, unless said otherwise. Context: cycle boundary; wait-free.
class EdgeAccess final : public JobThreads {
 public:
  /// The references are used from attach() on and outlive it. Context: setup.
  EdgeAccess(Releases& releases, ReadyJobs& ready, Processor& processor, JobClock& clock, std::size_t n_tasks);

  /// The calling thread takes the edges from here on. Context: setup; outside the section.
  void attach() noexcept;

  bool claim(TaskId task) noexcept override;
  Nanoseconds used_by_job(TaskId task) noexcept override;
  /// As look_up_blocked() found it.
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

  /// Releases are taken, before `until`; all threads look at their tasks.
  void open(Nanoseconds until) noexcept;
  /// Threads follow the states of their tasks. Those for which nothing is new sleep on.
  void follow_all() noexcept;

  /// Which jobs the edge at `now` reports as late that have begun and are not looked up yet. True when there are some:
  /// look_up_blocked() is due.
  bool collect_late(Nanoseconds now) noexcept;
  /// Finds out which of the collected jobs sleep in a system call. Context: cycle boundary; outside the section; may
  /// block for some microseconds a job, in which others act.
  void look_up_blocked() noexcept;
  /// The edge has reported what was missed.
  void forget_blocked() noexcept;

 private:
  /// Of the job of a task that is late.
  struct LookUp {
    bool is_due = false, is_done = false, is_blocked = false;
  };

  // The end of a job that is waited for asks for an edge; this is for one that never comes.
  static constexpr Nanoseconds kLook = milliseconds(1);

  void follow(JobThread& job, bool is_new) noexcept;
  JobThread* leave_for(TaskId task) noexcept;
  void return_from(JobThread& job) noexcept;

  Releases& releases_;
  ReadyJobs& ready_;
  Processor& processor_;
  JobClock& clock_;
  std::vector<LookUp> look_ups_;  // by task
  pid_t thread_ = 0;              // 0: nobody runs yet
  Nanoseconds end_ = kNever;      // of the run
};

}  // namespace chimera
