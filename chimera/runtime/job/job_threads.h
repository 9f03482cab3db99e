// SPDX-License-Identifier: Apache-2.0
// The threads that run the jobs of a context: one for each task, or the thread that handles cycle boundaries.
#pragma once

#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/mechanisms.h"
#include "chimera/base/time.h"
#include "chimera/runtime/job/job_step.h"
#include "chimera/schedule/ready_queue.h"
#include "chimera/task/task.h"

namespace chimera {

/// Operations on the threads of jobs that cycle boundaries need.
class JobThreads {
 public:
  /// Keeps the task's thread from beginning a job until the cycle boundary is over; a job that waits is put back. False
  /// while a job of it is under way: then a cycle boundary follows its end. Context: cycle boundary; wait-free.
  virtual bool claim(TaskId task) noexcept = 0;
  /// Execution time of the job of the task that is under way; 0 without one. Context: cycle boundary; wait-free.
  virtual Nanoseconds used_by_job(TaskId task) noexcept = 0;
  /// True if the job of the task that is under way was found waiting in a system call, before this cycle boundary.
  /// Context: cycle boundary; wait-free.
  virtual bool is_blocked(TaskId task) noexcept = 0;
  /// Calls a method of a task at a cycle boundary, as call_method(). Where jobs preempt each other it runs at the
  /// urgency of the task, and data that the cycle boundary may touch can change during the call. Context: cycle
  /// boundary; as long as the method takes.
  virtual Answer call(Task& task, Method method, Nanoseconds now) noexcept { return call_method(task, method, now); }

  // For a switch (switching.h). Context of all: cycle boundary; wait-free.

  /// call() delays no job that is more urgent than the task: no idle gap has to be waited for.
  virtual bool run_beside_methods() const noexcept = 0;
  /// Jobs preempt each other, so a method needs no idle gap. In virtual time a method holds the processor all the same,
  /// and runs in a gap that comes soon.
  virtual bool preempt() const noexcept = 0;
  /// No job has taken a later release.
  virtual Nanoseconds latest_release() const noexcept = 0;
  /// A job that was released before `at` is under way, or waits.
  virtual bool has_job_before(TaskId task, Nanoseconds at) const noexcept = 0;
  /// Asks for a cycle boundary at the end of the job that is under way, or of the next one. The task has no other job
  /// before it.
  virtual void await_job(TaskId task) noexcept = 0;
  /// Holds all releases at `from` and later, of each task until let_release() of it.
  virtual void hold_releases(Nanoseconds from) noexcept = 0;
  /// The task is released as its state says, its held releases included. No effect on tasks of other contexts.
  virtual void let_release(TaskId task) noexcept = 0;
  /// When a cycle boundary that waits for jobs may find something new although none is asked for.
  virtual Nanoseconds next_look(Nanoseconds now) const noexcept = 0;

 protected:
  ~JobThreads() = default;
};

/// Jobs run in the thread that handles cycle boundaries. Between two jobs none is under way, except one that virtual
/// time has begun and not ended. That thread takes no release during a cycle boundary.
class JobsInLoop : public JobThreads {
 public:
  /// Both outlive this; `queue` may be null if nothing is switched. Context: setup.
  /// `preemptive`: in virtual time jobs preempt each other.
  JobsInLoop(std::span<const Task> tasks, const ReadyQueue* queue, bool preemptive = false) noexcept
      : tasks_(tasks), queue_(queue), preemptive_(preemptive) {}

  bool claim(TaskId task) noexcept override { return !tasks_[task.index].is_busy; }
  Nanoseconds used_by_job(TaskId) noexcept override { return {}; }
  bool is_blocked(TaskId) noexcept override { return false; }
  bool run_beside_methods() const noexcept override { return false; }
  bool preempt() const noexcept override { return preemptive_; }
  Nanoseconds latest_release() const noexcept override {
    return mechanisms::kSwitch ? queue_->latest_release() : Nanoseconds{};
  }
  bool has_job_before(TaskId task, Nanoseconds at) const noexcept override {
    return mechanisms::kSwitch && (tasks_[task.index].is_busy || queue_->has_waiting(task, at));
  }
  void await_job(TaskId) noexcept override {}
  void hold_releases(Nanoseconds) noexcept override {}
  void let_release(TaskId) noexcept override {}
  Nanoseconds next_look(Nanoseconds) const noexcept override { return queue_->next_release(); }

 private:
  std::span<const Task> tasks_;
  const ReadyQueue* queue_;
  bool preemptive_;
};

}  // namespace chimera
