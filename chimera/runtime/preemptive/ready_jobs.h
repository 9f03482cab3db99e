// SPDX-License-Identifier: Apache-2.0
// The jobs of one processor that are ready, in order of urgency, each at its level: what LabelList says of them is told
// to the kernel here.
#pragma once

#include <deque>
#include <vector>

#include "chimera/runtime/preemptive/job_thread.h"
#include "chimera/runtime/preemptive/label_list.h"
#include "chimera/runtime/preemptive/processor_place.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// In the section, unless said otherwise. Context: cycle; wait-free but for the system calls that change levels.
class ReadyJobs {
 public:
  /// Of the tasks of `set` that are its own. Context: setup.
  ReadyJobs(TaskSet& set, const ProcessorPlace& place, Policy policy);

  /// Of the tasks of this context, ready or not.
  std::deque<JobThread>& threads() noexcept { return threads_; }
  const std::deque<JobThread>& threads() const noexcept { return threads_; }
  /// Null: a task of another context.
  JobThread* of(TaskId task) noexcept { return of_task_[task.index]; }
  const JobThread* of(TaskId task) const noexcept { return of_task_[task.index]; }

  /// The job of the task, or another method of it, is ready and due at `deadline`. Answers with the level to which the
  /// thread of `own` (null: nobody) lowers itself; the levels of all others are changed here.
  int insert(JobThread& job, Nanoseconds deadline, Nanoseconds remaining, const JobThread* own) noexcept;
  /// No effect on one that is not ready.
  void remove(JobThread& job) noexcept { (void)apply(labels_.remove(job.id), nullptr); }
  /// The urgency of the job changed; no effect on one that is not ready.
  void rekey(JobThread& job, Nanoseconds remaining) noexcept;
  /// At equal urgency this job, which has the processor, goes on; null: nobody's.
  void prefer(const JobThread* job) noexcept { labels_.dispatch(job == nullptr ? TaskId() : job->id); }
  /// When the job is due: by its own deadline, or that of its server.
  static Nanoseconds deadline_of(const JobThread& job) noexcept {
    return job.sporadic ? job.sporadic->job().deadline() : job.job.deadline;
  }

  std::size_t size() const noexcept { return labels_.size(); }
  Policy policy() const noexcept { return labels_.policy(); }
  /// In ascending urgency; i < size().
  JobThread& operator[](std::size_t i) noexcept { return *of_task_[labels_.jobs()[i].task.index]; }
  /// Null: none is ready.
  JobThread* most_urgent() noexcept { return size() == 0 ? nullptr : &(*this)[size() - 1]; }
  /// The most urgent job that has begun: it has the processor, unless it sleeps in a system call. Null: none has.
  JobThread* most_urgent_running() noexcept;

  /// The calling thread goes to the processor, at the ceiling. Context: setup; outside the section.
  void attach_thread() noexcept;
  /// The calling thread, to the ceiling. Context: cycle; outside the section.
  void raise() noexcept;
  /// The calling thread, to the level that insert() answered with. Context: cycle; outside the section.
  void lower(int level) noexcept;
  /// Who runs for the task, to the ceiling.
  void raise(const JobThread& job) noexcept;
  /// Who runs for the task, below all real-time threads.
  void lower_below_all(const JobThread& job) noexcept;

  std::uint64_t level_changes() const noexcept { return level_changes_; }
  /// Jobs that the kernel does not run at their labels, or whose labels are not in order of urgency; jobs on their way
  /// to the ceiling apart. For tests: a system call for each job.
  std::size_t count_wrong() const noexcept;

 private:
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
