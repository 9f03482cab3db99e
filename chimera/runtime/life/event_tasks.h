// SPDX-License-Identifier: Apache-2.0
// Tasks that events release in a loop without preemption (TaskSpec::has_events): a job for each event, one period
// after the previous release at the earliest. So a task with events needs no more time than a periodic one.
//
//   ring, input --count--> Task::events --follow(): release = noticed, or last release + period--> ready queue
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/base/setup_memory.h"
#include "chimera/runtime/job/job_record.h"
#include "chimera/runtime/life/event_inputs.h"
#include "chimera/runtime/life/sent_signals.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; wait-free; O(tasks with events).
class EventTasks {
 public:
  /// Where the events of a context come from, `inputs` (null: none) every `tick`, and where its jobs go.
  struct Parts {
    std::span<JobRecord> records;
    ReadyQueue& queue;
    SentSignals& sent;
    EventInputs* inputs = nullptr;
    Nanoseconds tick;
  };

  explicit EventTasks(const Parts& parts) noexcept : parts_(parts) {}
  /// Takes care of the `n` tasks of this context that have events; then calls add() for each. Context: setup.
  void prepare(std::size_t n, SetupMemory& memory) { tasks_ = memory.take<EventTask>(n); }
  void add(Task& task) noexcept;
  bool are_none() const noexcept { return !mechanisms::kEvents || tasks_.empty(); }
  /// Ticks count from `origin`.
  void begin(Nanoseconds origin) noexcept;

  /// The task goes ON. False: it polls for events as a periodic task. So does a task with a descriptor if there
  /// are no inputs, as in virtual time.
  bool join(Task& task, Nanoseconds now) noexcept;
  /// The task is no longer ON, and its waiting events are lost.
  void leave(Task& task) noexcept;
  /// Reads the inputs if a tick is due, and puts the jobs that are due into the ready queue.
  void follow(Nanoseconds now) noexcept;
  /// The present job of the task is over or was dropped.
  void finish(TaskId task) noexcept;
  /// When follow() has something to do if no ring comes; kNever: not by itself. Context: cycle; wait-free; O(1).
  Nanoseconds due() const noexcept { return due_ < next_tick_ ? due_ : next_tick_; }
  /// Release of the oldest event of the task that no job has answered; kNever: there is none.
  Nanoseconds oldest(TaskId task) const noexcept;

 private:
  struct EventTask {
    Task* task = nullptr;
    std::uint32_t noticed = 0;  ///< events of Task::events whose release is known
    bool is_ready = false;      ///< a job waits or runs
    Nanoseconds last{INT64_MIN / 4};  ///< release of the newest event
    /// Release of the next job. Under overload it may be later than necessary, but never before the event.
    Nanoseconds next() const noexcept { return last - task->spec->period * (std::int64_t{noticed} - 1); }
  };

  EventTask* find(TaskId task) noexcept;
  void read_inputs(Nanoseconds now) noexcept;
  void release(EventTask& one, Nanoseconds now) noexcept;
  void look_ahead() noexcept;

  Parts parts_;
  std::span<EventTask> tasks_;
  Nanoseconds due_ = kNever;        // the next release
  Nanoseconds next_tick_ = kNever;  // kNever: there are no inputs
};

}  // namespace chimera
