// SPDX-License-Identifier: Apache-2.0
// Follows the tasks that take part in releases: those that are ON.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/runtime/job/job_record.h"
#include "chimera/runtime/life/boundary_listener.h"
#include "chimera/runtime/life/event_tasks.h"
#include "chimera/runtime/record/context_tap.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera {

/// Makes the ready queue follow the states of the tasks. Context of everything not marked: cycle boundary; no
/// allocation.
class Members {
 public:
  /// All arguments outlive this. A null listener: profiles are not shown. Context: setup.
  Members(std::span<Task> tasks, std::span<JobRecord> records, ReadyQueue& queue, EventTasks& events, ContextTap& tap,
          BoundaryListener* guest) noexcept
      : tasks_(tasks), records_(records), queue_(queue), events_(events), tap_(tap), guest_(guest) {}

  /// The task was ON at the last follow(). Context: cycle; wait-free.
  bool is_on(TaskId task) const noexcept { return records_[task.index].is_on; }
  /// Some task was ON at the last follow(). Context: cycle; wait-free.
  bool is_any_on() const noexcept { return n_on_ > 0; }
  EventTasks& events() noexcept { return events_; }
  /// Tasks that went ON join the releases; those that are no longer ON leave. Not while a job of them is under way.
  void follow_all(Nanoseconds now) noexcept;
  /// Follows one task. Requires: no job of it is under way.
  void follow(Task& task, Nanoseconds now) noexcept;

 private:
  void join(Task& task, Nanoseconds now) noexcept;
  void leave(Task& task) noexcept;
  void lose_events(Task& task) noexcept;

  std::span<Task> tasks_;
  std::span<JobRecord> records_;
  ReadyQueue& queue_;
  EventTasks& events_;
  ContextTap& tap_;
  BoundaryListener* guest_;
  std::uint32_t n_on_ = 0;
};

}  // namespace chimera
