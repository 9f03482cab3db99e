// SPDX-License-Identifier: Apache-2.0
// Preemptive scheduling of one processor in real time: a thread per task under SCHED_FIFO, no dispatcher.
//
//   thread of a task:  sleep at the ceiling | [release, label] | body at the label | raise | [end]     job_loop.h
//   cycle boundaries:  the caller of run(), at the ceiling; other methods run at the label of their task  edge_access.h
//   supervisor:        at the ceiling, woken by one alarm: budgets, deadlines, hanging jobs, capacities   supervisor.h
//
// [...] is the section (processor.h): shared data is touched there and nowhere else.
// docs/design/preemptive.md; the figures behind it: labels cost 0.4 of a dispatcher thread.
#pragma once

#include "chimera/runtime/preemptive/edge_access.h"
#include "chimera/runtime/preemptive/job_loop.h"

namespace chimera {

/// Runs the tasks of `set`, which was made with ContextPlace::preemptive. The set and what the options point at
/// outlive it.
class PreemptiveExecutor final {
 public:
  /// Starts the threads, asleep. Context: setup; may block.
  PreemptiveExecutor(TaskSet& set, const RunOptions& options, const ProcessorPlace& place);
  PreemptiveExecutor(const PreemptiveExecutor&) = delete;
  PreemptiveExecutor& operator=(const PreemptiveExecutor&) = delete;
  /// Ends the threads; a job that hangs is waited for. Context: setup; may block.
  ~PreemptiveExecutor();

  /// Spawns all tasks and turns the start set ON; the grid of releases begins when that is done. Refuses as
  /// TaskLife::start. Context: setup.
  Result<void> start();
  /// Begins with nothing spawned, on a grid of releases that others share. Context: setup.
  void start(Nanoseconds origin);
  Releases& releases() noexcept { return releases_; }
  /// Runs until `duration` from the origin of the grid (kNever: without limit): no job is released from there on, those
  /// under way are waited for. May be called again to go on. Context: the thread that handles cycle boundaries.
  RunEnd run(Nanoseconds duration) noexcept;
  /// Carries out `act` as a cycle boundary. Context: setup, between runs.
  template <class Act>
  void at_edge(Act&& act) {
    processor_.enter();
    act();
    processor_.leave();
  }
  /// off and kill for every task. Context: setup, between runs.
  void shut_down() noexcept;

  Nanoseconds origin() const noexcept { return releases_.origin(); }
  std::span<const RefusedSignal> refused() noexcept { return releases_.signals().refused(); }
  /// Context: between runs.
  ProcessorCounts counts() const noexcept { return processor_.seen(); }

 private:
  Nanoseconds enter_with_look_ups() noexcept;
  void run_edge(Nanoseconds now) noexcept;
  void report_hanging(Nanoseconds now) noexcept;
  bool is_over(RunEnd& end, Nanoseconds until, Nanoseconds now) noexcept;
  bool is_idle() const noexcept;
  void stop_jobs(RunEnd end) noexcept;

  TaskSet& set_;
  BoundaryListener* guest_;
  ThreadClock clock_;
  EdgeAccess access_;
  Releases releases_;
  ReadyJobs ready_;
  ProcessorShare share_;
  JobChecks checks_;
  Processor processor_;
  Supervisor supervisor_;
  JobLoop jobs_;
  std::atomic<std::size_t> n_attached_{0};  // threads at the ceiling: pairs with their fetch_add()
};

}  // namespace chimera
