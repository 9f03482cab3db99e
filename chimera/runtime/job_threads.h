// SPDX-License-Identifier: Apache-2.0
// Who runs the jobs of a context: threads of their own, or the thread that takes the edges.
#pragma once

#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/runtime/job_step.h"
#include "chimera/task/task.h"

namespace chimera {

/// What edges ask of whoever runs the jobs.
class JobThreads {
 public:
  /// Keeps the task's thread from beginning a job until the edge is over; a job that waits is put back. False while a
  /// job of it is under way: then an edge follows its end. Context: cycle boundary; wait-free.
  virtual bool claim(TaskId task) noexcept = 0;
  /// Execution time of the job of the task that is under way; 0 without one. Context: cycle boundary; wait-free.
  virtual Nanoseconds used_by_job(TaskId task) noexcept = 0;
  /// True when the job of the task that is under way was found waiting in a system call, before this edge.
  /// Context: cycle boundary; wait-free.
  virtual bool is_blocked(TaskId task) noexcept = 0;
  /// Calls a method of a task at an edge, as call_method(): where jobs preempt each other at the urgency of the task,
  /// and what the edge may touch may change meanwhile. Context: cycle boundary; as long as the method takes.
  virtual Answer call(Task& task, Method method, Nanoseconds now) noexcept { return call_method(task, method, now); }

 protected:
  ~JobThreads() = default;
};

/// Jobs run in the thread that takes the edges: between two jobs none is under way, but for one that virtual time has
/// begun and not ended.
class JobsInLoop final : public JobThreads {
 public:
  /// The tasks outlive this. Context: setup.
  explicit JobsInLoop(std::span<const Task> tasks) noexcept : tasks_(tasks) {}

  bool claim(TaskId task) noexcept override { return !tasks_[task.index].is_busy; }
  Nanoseconds used_by_job(TaskId) noexcept override { return {}; }
  bool is_blocked(TaskId) noexcept override { return false; }

 private:
  std::span<const Task> tasks_;
};

}  // namespace chimera
