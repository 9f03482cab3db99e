// SPDX-License-Identifier: Apache-2.0
// The tasks behind servers in virtual time: their events, and whether their jobs may run now. A job whose server has
// capacity is in the ready queue or has the processor; without capacity it is nowhere.
#pragma once

#include <span>
#include <vector>

#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/job/sporadic_job.h"
#include "chimera/runtime/virtual/virtual_processor.h"

namespace chimera {

/// Context: cycle; no allocation; one thread at a time.
class SporadicTasks {
 public:
  /// Handles the tasks of `tasks` that have a server. All arguments outlive this. Context: setup.
  SporadicTasks(Releases& releases, std::span<const TaskSpec> tasks, VirtualProcessor& processor);

  bool are_none() const noexcept { return sporadic_.empty(); }
  /// The periods of servers count from the origin of the grid. No effect the second time.
  void open() noexcept;
  /// When follow() may change something; kNever: not by itself.
  Nanoseconds next_change(Nanoseconds now) noexcept;
  /// Takes the events that have come, and puts each job where its server lets it be.
  void follow(Nanoseconds now) noexcept;
  /// The job of the task used so much of the processor. No effect on a task without a server.
  void charge(TaskId task, Nanoseconds used) noexcept;
  /// The job of the task is over, or never began. No effect on a task without a server.
  void finish(TaskId task) noexcept;
  /// The job as the failures of time see it: behind a server it has no deadline of its own.
  Job without_server(Job job) const noexcept;

 private:
  struct SporadicTask {
    TaskId task;
    SporadicJob job;
    bool is_ready = false;  // the job is in the queue or has the processor
  };

  bool accept_event(SporadicTask& task, Nanoseconds now) noexcept;
  void apply_grant(SporadicTask& task, Nanoseconds now) noexcept;
  void halt(SporadicTask& task, Nanoseconds now) noexcept;
  SporadicTask* find(TaskId task) noexcept;

  Releases& releases_;
  std::span<const TaskSpec> tasks_;
  VirtualProcessor& processor_;
  std::vector<SporadicTask> sporadic_;
  bool is_open_ = false;
};

}  // namespace chimera
