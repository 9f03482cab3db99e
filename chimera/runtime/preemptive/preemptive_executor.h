// SPDX-License-Identifier: Apache-2.0
// Preemptive scheduling of one processor in real time: a thread per task under SCHED_FIFO, no dispatcher.
//
//   thread of a task:  sleep at the ceiling | [release, label] | body at the label | raise | [end, next release]
//   edges:             the caller of run(), at the ceiling; other methods run at the label of their task
//   supervisor:        at the ceiling, woken by one alarm: budgets, deadlines, hanging jobs, capacities of servers
//
// [...] is the section: what all share is touched there and nowhere else. Every thread that enters it runs at the
// ceiling, on one CPU, and neither blocks nor faults in it, so the kernel's own order excludes; the lock behind it is
// for those who run without real-time rights. A job lowers itself to its label as the last thing of the section: the
// order of labels is the order of urgency and the kernel dispatches. A job that blocks, loops or dies holds nothing.
// docs/decisions/0009-preemptive-executor.md; the figures behind it: labels cost 0.4 of a dispatcher thread.
#pragma once

#include <algorithm>
#include <deque>
#include <vector>

#include "chimera/platform/alarm.h"
#include "chimera/platform/doorbell.h"
#include "chimera/platform/section.h"
#include "chimera/platform/switch_watch.h"
#include "chimera/runtime/preemptive/job_thread.h"
#include "chimera/runtime/preemptive/label_list.h"
#include "chimera/runtime/preemptive/thread_clock.h"
#include "chimera/runtime/releases.h"
#include "chimera/schedule/recent_use.h"

namespace chimera {

/// Where a preemptive context runs.
struct ProcessorPlace {
  int cpu = -1;       ///< -1: any (without real-time levels)
  int ceiling = 0;    ///< SCHED_FIFO level of the section; 0: no real-time levels at all
  int base = 0;       ///< of jobs that found no level of their own; labels lie between; ceiling - base >= 2
  Nanoseconds quantum = microseconds(500);  ///< of the laxity policy
  /// Of each `window` jobs may use so much; then some go on below all others, before the kernel takes the processor
  /// from all of them (sched_rt_runtime_us). kNever: no limit.
  Nanoseconds share = kNever, window = seconds(1);
  bool checks = false;  ///< looks up every level in the kernel at every entry to the section: for tests, costs
  /// Rung when an edge is due; run() sleeps on it. Null: one of its own.
  std::atomic<std::uint32_t>* bell = nullptr;
};

/// What was seen of the section and the levels, for tests and figures.
struct ProcessorCounts {
  std::uint64_t jobs = 0;
  std::uint64_t level_changes = 0;
  std::uint64_t preemptions = 0;
  std::uint64_t ended_unseen = 0;   ///< a job was over, and others were released before its thread could say so
  std::uint64_t supervised = 0;     ///< times the alarm rang
  std::uint64_t wrong_levels = 0;   ///< with checks: a job did not run at its label, or labels were out of order
  std::uint64_t checked = 0;        ///< with checks: entries to the section
  /// Times the section was found taken: 0 with real-time levels. With checks: while its holder was awake.
  std::uint64_t section_taken = 0;
  /// With checks: times it was found taken while the kernel had its holder asleep (a page that had to be fetched; a
  /// virtual machine fetches pages from its host).
  std::uint64_t taken_asleep = 0;
};

/// Runs the tasks of `set`, which was made with ContextPlace::preemptive. The set and what the options point at
/// outlive it.
class PreemptiveExecutor final : private JobThreads {
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
  /// under way are waited for. May be called again to go on. Context: the thread that takes the edges.
  RunEnd run(Nanoseconds duration) noexcept;
  /// Carries out `act` as an edge. Context: setup, between runs.
  template <class Act>
  void at_edge(Act&& act) {
    enter();
    act();
    leave();
  }
  /// off and kill for every task. Context: setup, between runs.
  void shut_down() noexcept;

  Nanoseconds origin() const noexcept { return releases_.origin(); }
  std::span<const RefusedSignal> refused() const noexcept { return releases_.signals().refused(); }
  /// Context: between runs.
  ProcessorCounts counts() const noexcept;

 private:
  // Edges (edges.cc).
  bool claim(TaskId task) noexcept override;
  Nanoseconds used_by_job(TaskId task) noexcept override;
  bool is_blocked(TaskId task) noexcept override;
  Answer call(Task& task, Method method, Nanoseconds now) noexcept override;
  void open(TaskId task) noexcept;
  void close(TaskId task) noexcept;
  bool take_edge(RunEnd& end, Nanoseconds until) noexcept;
  void tell_threads(bool all) noexcept;
  void stop_jobs(RunEnd end) noexcept;
  bool is_idle() const noexcept;
  void ring_edge() noexcept { Doorbell(*bell_).ring(); }
  static void wake(JobThread& job) noexcept {
    job.bell.ring();
    if (job.served) job.served->bell.ring();
  }

  // Jobs (job.cc).
  void follow_releases(JobThread& me);
  void run_job(JobThread& me, Nanoseconds now) noexcept;
  bool release(JobThread& me, Nanoseconds now) noexcept;
  void prepare(JobThread& me, const Job& job) noexcept;
  int enter_label(JobThread& me, Nanoseconds now) noexcept;
  bool begin(JobThread& me) noexcept;
  Nanoseconds run_body(JobThread& me) noexcept;
  void end(JobThread& me, Nanoseconds now) noexcept;
  void record_slice(const JobThread& job, Nanoseconds now) noexcept;
  void processor_goes_on(Nanoseconds now) noexcept;
  void show_running() noexcept;
  void show(JobThread& job, Nanoseconds now) noexcept;

  // Tasks behind servers (servers.cc).
  void open_servers(Nanoseconds origin) noexcept;
  void take_event(JobThread& me, Nanoseconds now) noexcept;
  void forget_event(JobThread& job) noexcept;
  bool listens(const JobThread& me) const noexcept;
  void pay(JobThread& job) noexcept;
  void follow_server(JobThread& job, Nanoseconds now) noexcept;
  void halt(JobThread& job, Nanoseconds now) noexcept;
  void let_go_on(JobThread& job, Nanoseconds now) noexcept;
  void end_served(JobThread& me) noexcept;
  Nanoseconds end_of_capacity(JobThread& job, Nanoseconds now) noexcept;
  Nanoseconds next_look_at_server(JobThread& job, Nanoseconds now) noexcept;

  // Levels (levels.cc).
  JobThread* running() noexcept;
  int apply(std::span<const LevelChange> changes, const JobThread* own) noexcept;
  Urgency urgency_of(const JobThread& job, Nanoseconds remaining) const noexcept;
  void check() noexcept;
  void check_holder() noexcept;
  void raise() noexcept;
  void lower(int level) noexcept;

  // The share of the processor (share.cc).
  void find_less_important();
  void keep_share(Nanoseconds now, const JobThread* own) noexcept;
  JobThread* who_gives_way(bool anybody, const JobThread* own) noexcept;
  void give_way(JobThread& job, Nanoseconds now) noexcept;

  // Supervision (supervisor.cc).
  void supervise();
  void look_at_jobs(Nanoseconds now) noexcept;
  void look_at(JobThread& job, Nanoseconds now) noexcept;
  void look_at_waiting(JobThread& job, Nanoseconds now) noexcept;
  Nanoseconds end_of_budget(JobThread& job, Nanoseconds now) noexcept;
  void look_at_begun(JobThread& job, Nanoseconds now) noexcept;
  void charge_running(Nanoseconds now) noexcept;
  void charge(JobThread& job, Nanoseconds now) noexcept;
  void overrun(JobThread& job, Nanoseconds now) noexcept;
  void tell_late(const JobThread& job, bool has_begun) noexcept;
  bool sleeps_for_ever(JobThread& job, Nanoseconds spent, Nanoseconds now) noexcept;
  void hang(JobThread& job, Nanoseconds spent, Nanoseconds now) noexcept;
  void bury(JobThread& job, Nanoseconds now) noexcept;
  void demote(JobThread& job, Nanoseconds now) noexcept;
  void cancel(JobThread& job, Nanoseconds now) noexcept;
  void watch(JobThread& job, Nanoseconds check) noexcept;
  Nanoseconds alarm_for(Nanoseconds check, bool is_exact) const noexcept;
  Nanoseconds next_late(Nanoseconds now) const noexcept;
  void put_off_alarm(Nanoseconds now) noexcept;
  void arm(Nanoseconds instant) noexcept;
  Nanoseconds used(const JobThread& job) const noexcept;
  /// Releases of this run come up to here: at its end and later there is none.
  Nanoseconds newest_instant(Nanoseconds now) const noexcept { return std::min(now, until_ - Nanoseconds{1}); }
  Nanoseconds next_quantum(Nanoseconds now) const noexcept;
  static bool acts_at_once(OnMiss reaction) noexcept;
  void enter() noexcept {
    section_.enter();
    labels_.dispatch(on_processor_ == nullptr ? TaskId() : on_processor_->task);
    if (place_.checks) check();
  }
  void leave() noexcept {
    if (place_.checks) check_holder();
    section_.leave();
  }
  const TaskSpec& spec(const JobThread& job) const noexcept { return *tasks_[job.task.index].spec; }
  Task& task(const JobThread& job) noexcept { return tasks_[job.task.index]; }

  TaskSet& set_;
  std::span<Task> tasks_;
  ThreadClock clock_;
  ProcessorPlace place_;
  EdgeGuest* guest_;
  Releases releases_;
  Section section_;
  LabelList labels_;
  std::deque<JobThread> threads_;        // of the tasks of this context
  std::vector<JobThread*> of_task_;      // by task; null: of another context
  std::atomic<std::uint32_t> own_bell_{0};
  std::atomic<std::uint32_t>* bell_;
  Alarm alarm_;
  Nanoseconds armed_ = kNever;
  bool is_lax_ = false;                  // a job in the list has a check that the alarm does not know of
  std::thread supervisor_;
  pid_t edge_thread_ = 0;
  JobThread* on_processor_ = nullptr;    // the most urgent job at the last change of the list
  const bool sees_switches_ = SwitchWatch::can_tell();
  RecentUse use_, use_by_less_;          // of the processor, by jobs; by those of less important tasks
  Nanoseconds kept_for_important_;       // of the share
  Nanoseconds shortest_ = seconds(1);    // of the deadlines, from the release on; at most
  TaskId gave_way_;                      // that is to be told: for the sake of the share
  Nanoseconds told_;                     // when it was told last
  bool has_levels_ = false;              // else the system refused them, and threads run as it likes
  bool is_paused_ = true;                // no job is released
  Nanoseconds until_ = kNever;           // nor from here on
  std::atomic<bool> quits_{false};
  std::atomic<std::size_t> n_ready_{0};  // threads that are where they belong
  ProcessorCounts counts_;
  std::uint64_t taken_before_ = 0, sleeps_before_ = 0;  // with checks: when the section was entered
};

}  // namespace chimera
