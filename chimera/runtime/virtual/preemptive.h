// SPDX-License-Identifier: Apache-2.0
// Preemptive scheduling of one processor in virtual time: a discrete-event simulation that runs the real bodies.
//
// A body runs at its first dispatch (inputs as they are then) and its job then holds the processor for the modelled
// time, in slices; it publishes, and its signals leave, when that time is used up. Order of things at one instant:
// completion (publication), deadlines of jobs with the reaction abort, demotions, signals, releases, servers, dispatch
// (reads).
//
// Behind a server a job is released by an event, one after the other. It is as urgent as its server, leaves the
// processor when the capacity is used up, and goes on when some is back. It has no deadline of its own.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/virtual/modelled_clock.h"
#include "chimera/runtime/virtual/sporadic_tasks.h"
#include "chimera/runtime/virtual/virtual_processor.h"

namespace chimera {

/// How the processor is shared. Context: setup.
struct PreemptiveOptions {
  std::optional<JobTimes> times;
  Nanoseconds quantum = milliseconds(1);  ///< laxity policies compare the running job again at every multiple of it
};

/// The processor. Context of run: cycle; no allocation.
class Preemptive {
 public:
  Preemptive(Releases& releases, std::span<const TaskSpec> tasks, ModelledClock& clock,
             const PreemptiveOptions& options);

  /// Runs from `now` to `until`, where a job under way is cut: it neither completes nor counts. May be called again
  /// to go on. `now` receives the time reached.
  RunEnd run(Nanoseconds& now, Nanoseconds until) noexcept;

  // The parts of run(), for a caller that advances several processors together: stepped_preemptive.h.

  /// Ends what is over at `now`: the job that has the processor, and jobs at their deadlines or budgets. The grid of
  /// releases has begun.
  void end_due(Nanoseconds now) noexcept;
  /// Runs the cycle boundary of `now`, which receives the time reached.
  void run_edge(Nanoseconds& now) noexcept;
  /// Gives the processor to the most urgent job. True if the instant is not over: a job needs no time, and ends in the
  /// next end_due().
  bool dispatch_by_step(Nanoseconds now) noexcept;
  Nanoseconds next_event(Nanoseconds now) noexcept;
  bool is_idle() const noexcept { return processor_.is_idle() && releases_.queue().is_empty(); }
  /// Records the slice of the job that has the processor, up to `now`.
  void record_slice(Nanoseconds now) noexcept;
  /// Checks events and servers.
  void follow_servers(Nanoseconds now) noexcept {
    if (!sporadic_.are_none()) sporadic_.follow(now);
  }

 private:
  /// Place that decides at which instant a job is over.
  enum class Ends : std::uint8_t { kHere, kElsewhere };
  /// A task whose jobs are ended at their deadline.
  struct Abandoner {
    TaskId task;
    Nanoseconds next_deadline = kNever;  // of the task while it is ON
  };

  Nanoseconds next_exception(Nanoseconds now) noexcept;
  bool has_exceptions() const noexcept { return !abandoners_.empty() || has_demotion_ || !sporadic_.are_none(); }
  Nanoseconds next_deadline() noexcept;
  Nanoseconds next_demotion(Nanoseconds now) noexcept;
  Nanoseconds budget_left(TaskId task) const noexcept;
  void end_all_due(Nanoseconds now) noexcept;
  template <Ends kEnds>
  bool dispatch(Nanoseconds& now) noexcept;
  void use_processor(Nanoseconds until) noexcept;
  void complete() noexcept;
  void expire(Nanoseconds now) noexcept;
  void expire(TaskId task, Nanoseconds deadline) noexcept;
  void demote_due(Nanoseconds now) noexcept;
  void demote(TaskId task) noexcept;
  bool runs_through(Nanoseconds end) const noexcept;
  bool must_yield() noexcept;
  void preempt(Nanoseconds now) noexcept;
  bool run_job(const Job& job, Nanoseconds now) noexcept;
  void end(BegunJob& ended, Nanoseconds now) noexcept;

  Releases& releases_;
  std::span<const TaskSpec> tasks_;
  ModelledClock& clock_;
  PreemptiveOptions options_;
  VirtualProcessor processor_;
  SporadicTasks sporadic_;
  std::vector<Abandoner> abandoners_;   // tasks with the reaction abort
  std::vector<TaskId> demoters_;        // tasks with the reaction demote to a missed deadline
  std::vector<TaskId> demoted_;         // their jobs run when no other job does, the first until it ends
  std::ptrdiff_t n_demoted_ = 0;
  bool by_laxity_;
  bool has_demotion_ = false;  // some task has it as a reaction
};

}  // namespace chimera
