// SPDX-License-Identifier: Apache-2.0
// The jobs of one processor that are ready, in order of urgency, each at its level. ReadyJobs passes the level changes
// of LabelList on to the kernel.
#pragma once

#include <deque>
#include <vector>

#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/preemptive/job_thread.h"
#include "chimera/runtime/preemptive/label_list.h"
#include "chimera/runtime/preemptive/processor_place.h"

namespace chimera {

/// In the section, unless said otherwise. Context: cycle; wait-free but for the system calls that change levels.
class ReadyJobs {
 public:
  /// Handles the tasks of `set` that belong to the rtpu of `set`. Context: setup.
  ReadyJobs(TaskSet& set, const ProcessorPlace& place, Policy policy);

  /// Threads of the tasks of this context, ready or not.
  std::deque<JobThread>& threads() noexcept { return threads_; }
  const std::deque<JobThread>& threads() const noexcept { return threads_; }
  /// Null: a task of another context.
  JobThread* of(TaskId task) noexcept { return of_task_[task.index]; }
  const JobThread* of(TaskId task) const noexcept { return of_task_[task.index]; }

  /// The job of the task, or another method of it, is ready and due at `deadline`. Returns the level to which the
  /// thread of `own` (null: none) lowers itself. The levels of all other threads are changed here. At equal urgency the
  /// most urgent job goes on if it has begun; otherwise tie_of() decides.
  int insert(JobThread& job, Nanoseconds deadline, Nanoseconds remaining, const JobThread* own) noexcept;
  /// No effect on a job that is not ready.
  void remove(JobThread& job) noexcept { (void)apply(labels_.remove(job.id), nullptr); }
  /// The urgency of the job changed. No effect on a job that is not ready.
  void rekey(JobThread& job, Nanoseconds remaining) noexcept;
  /// Returns the deadline of the job, or that of its server.
  static Nanoseconds deadline_of(const JobThread& job) noexcept {
    return job.sporadic ? job.sporadic->job().deadline() : job.job.deadline;
  }

  std::size_t size() const noexcept { return labels_.size(); }
  Policy policy() const noexcept { return labels_.policy(); }
  /// In ascending urgency; i < size().
  JobThread& operator[](std::size_t i) noexcept { return *of_task_[labels_.jobs()[i].task.index]; }
  /// Null: none is ready.
  JobThread* most_urgent() noexcept { return size() == 0 ? nullptr : &(*this)[size() - 1]; }
  /// The most urgent job that has begun. It has the processor, unless it sleeps in a system call. Null: none has begun.
  JobThread* most_urgent_running() noexcept;

  /// Moves the calling thread to the processor, at the ceiling. Context: setup; outside the section.
  void attach_thread() noexcept;
  /// Raises the calling thread to the ceiling. Context: cycle; outside the section.
  void raise() noexcept;
  /// Lowers the calling thread to the level that insert() returned. Context: cycle; outside the section.
  void lower(int level) noexcept;
  /// Raises the thread that runs for the task to the ceiling.
  void raise(const JobThread& job) noexcept;
  /// Lowers the thread that runs for the task below all real-time threads.
  void lower_below_all(const JobThread& job) noexcept;

  std::uint64_t level_changes() const noexcept { return level_changes_; }
  /// Jobs that the kernel does not run at their labels, or whose labels are not in order of urgency; jobs on their way
  /// to the ceiling apart. For tests: a system call for each job.
  std::size_t count_wrong() const noexcept;

 private:
  void prefer_begun() noexcept;
  int apply(std::span<const LevelChange> changes, const JobThread* own) noexcept;
  Urgency urgency_of(const JobThread& job, Nanoseconds deadline, Nanoseconds remaining) const noexcept;

  ProcessorPlace place_;
  bool has_levels_;  // else the system refused them, and threads run as it likes
  LabelList labels_;
  std::deque<JobThread> threads_;
  std::vector<JobThread*> of_task_;
  std::uint64_t level_changes_ = 0;
};

}  // namespace chimera
