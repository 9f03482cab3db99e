// SPDX-License-Identifier: Apache-2.0
// The common half of all executors of one context: the instants at which work is due, and the order of its parts.
//
//   edge: inputs of listener, script acts, signals    -> tasks join and leave the queue     BoundarySignals, Members
//   release_due: releases                             -> ready queue; what is dropped is counted
//   may_start: last chance to say no                  -> begin: inputs and body
//                                                     -> end: failures, publication, profile JobCycle, MissPolicy
//   settle: what jobs left for others to see                                                Settlement
//
// Executors differ in the time that a job takes, in the way they wait, and in the thread that runs a job. If jobs run
// in the thread that handles cycle boundaries, the executor uses may_start() and end_job(), which settle at once. An
// executor with a thread for each task calls jobs() and misses() in that thread, and settlement() at cycle boundaries.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>

#include "chimera/base/mechanisms.h"
#include "chimera/base/part_if.h"
#include "chimera/runtime/cycle/boundary_signals.h"
#include "chimera/runtime/cycle/recovery.h"
#include "chimera/runtime/cycle/run_options.h"
#include "chimera/runtime/job/job_cycle.h"
#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/job/miss_policy.h"
#include "chimera/runtime/life/members.h"
#include "chimera/runtime/life/settlement.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/switch/local_switches.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera {

/// A task may ask for a switch: there are configurations and more than one task, or a reaction leads to one.
bool may_request(const ApplicationSpec& spec) noexcept;
/// Number of receipts kept for unscripted events: switches that tasks ask for, and takeovers by standbys.
std::size_t kept_of_unscripted(const ApplicationSpec& spec) noexcept;

/// Owns the parts, which work in the memory that the set was built in. Context of everything not marked: cycle; no
/// allocation, no system call.
class Releases {
 public:
  /// `clock` is the one that methods see, and becomes the clock of the set. Requires: no task of this context with the
  /// reaction switch where there are other contexts without switch_peers, nor demote unless that can be done.
  /// Everything given outlives this. Context: setup.
  Releases(TaskSet& set, JobClock& clock, const RunOptions& options);
  Releases(const Releases&) = delete;
  Releases& operator=(const Releases&) = delete;

  /// The grid of releases starts at `origin`. Tasks that are ON now are released from there on. Context: cycle
  /// boundary.
  void begin(Nanoseconds origin) noexcept;
  Nanoseconds origin() const noexcept { return origin_; }

  /// True if a cycle boundary, a release or the end of the run may be due. False for most jobs of a row. On true, the
  /// caller checks all three and then calls rest().
  bool must_look(Nanoseconds now) const noexcept {
    return now >= calm_until_ || stop_requested() || (guest_ != nullptr && guest_->is_due(now));
  }
  /// Everything that is due has been checked. The run ends at `until`.
  void rest(Nanoseconds until) noexcept {
    const bool is_calm = !set_.sent().has_pending() && !settlement_.task_stopped();
    calm_until_ = is_calm ? std::min({queue_.next_release(), signals_.next_act(), until}) : kAtOnce;
  }
  /// The next must_look() is true.
  void look_again() noexcept { calm_until_ = kAtOnce; }
  /// True if take_edge() has something to do.
  bool edge_is_due(Nanoseconds now) const noexcept {
    return set_.sent().has_pending() || signals_.next_act() <= now || (guest_ != nullptr && guest_->is_due(now));
  }
  /// Carries out the acts and signals that are due. A signal for a task with an unfinished job waits for its end.
  /// `puts_off`: no job is ever under way at a cycle boundary. A cycle boundary that is due only for the end of jobs
  /// is put off until no job waits, or the next release is due.
  void take_edge(Nanoseconds now, bool puts_off = false) noexcept;
  /// The next instant at which a cycle boundary or a release may be due.
  Nanoseconds next_event() const noexcept { return std::min(queue_.next_release(), next_edge()); }
  /// The next instant at which a cycle boundary may be due. For executors whose releases have threads of their own.
  Nanoseconds next_edge() const noexcept {
    return guest_ == nullptr ? signals_.next_wake() : std::min(signals_.next_wake(), guest_->next_due());
  }
  /// True while a task is ON or may yet be turned ON.
  bool anything_left() const noexcept {
    return members_.is_any_on() || set_.sent().has_pending() || signals_.next_act() != kNever || guest_ != nullptr;
  }
  /// The run is over: ends all switches and takeovers that are under way.
  void end(Nanoseconds now) noexcept {
    if constexpr (mechanisms::kRecovery) recovery_->end(now);
    if constexpr (mechanisms::kSwitch) {
      switching_->end(now);
      if (*switches_) (*switches_)->end(now);
    }
  }
  bool stop_requested() const noexcept { return stop_->load(std::memory_order_relaxed); }

  void release_due(Nanoseconds now) noexcept {
    if (queue_.next_release() > now) return;
    queue_.release_due(now, [this](const DroppedRelease& d) { misses_.drop(d); });
    if (misses_.has_lost_patience()) [[unlikely]] {
      look_again();
      settlement_.give_up_starved(now);
    }
  }

  /// The illegal-configuration flag, to be read once for each job.
  bool is_illegal() const noexcept { return set_.flag().is_up(); }

  // Where jobs run in the thread that handles cycle boundaries.

  /// False if the job must not start. Its release is then counted as dropped, with all that follows.
  [[gnu::always_inline]] bool may_start(const Job& job, Nanoseconds now) noexcept {
    return jobs_.can_start(job, now) || decide_start(job, now);
  }
  /// The job ended at `end`, begun at `start` by JobCycle::open_and_begin(), having used `used` of execution time.
  [[gnu::always_inline]] void end_job(const Job& job, const CycleTime& time, BodyEnd body, Nanoseconds start,
                                      Nanoseconds end, Nanoseconds used) noexcept {
    if (jobs_.close_and_conclude(job, time, body, start, end, used)) settle_job(job.task, end);
  }
  /// Handles the failures and signals that jobs of the task left. Requires: no job is under way. Context: cycle
  /// boundary.
  void settle_job(TaskId task, Nanoseconds now) noexcept;

  ReadyQueue& queue() noexcept { return queue_; }
  Task& task(TaskId id) noexcept { return *records_[id.index].task; }
  JobCycle& jobs() noexcept { return jobs_; }
  MissPolicy& misses() noexcept { return misses_; }
  Members& members() noexcept { return members_; }
  BoundarySignals& signals() noexcept { return signals_; }
  Settlement& settlement() noexcept { return settlement_; }
  /// Receipts of switches and takeovers, if the application has one context; otherwise none. Context: setup, between
  /// runs.
  const SwitchReceipts& receipts() noexcept {
    if constexpr (mechanisms::kSwitch)
      if (*switches_) return (*switches_)->receipts();
    return kNoReceipts;
  }
  /// The trace that events of this context are recorded in.
  ContextTap& tap() noexcept { return tap_; }

 private:
  using HeardCause = PartIf<mechanisms::kBlame, std::optional<MissCause>>;
  static constexpr Nanoseconds kAtOnce{INT64_MIN};
  static constexpr std::atomic<bool> kNoStop{false};
  static constexpr SwitchReceipts kNoReceipts{};

  bool decide_start(const Job& job, Nanoseconds now) noexcept;

  TaskSet& set_;
  BoundaryListener* guest_;
  const std::atomic<bool>* stop_;  // set by other threads and by signal handlers; relaxed, pairs with nothing
  Nanoseconds origin_;
  Nanoseconds calm_until_ = kAtOnce;
  std::span<JobRecord> records_;
  ContextTap tap_;
  Digest* digest_;  // null: none
  JobsInLoop in_loop_;
  JobThreads& threads_;
  [[no_unique_address]] HeardCause heard_;
  MissCause* cause_;  // null without a listener, which reports it
  ReadyQueue queue_;
  MissPolicy misses_;
  JobCycle jobs_;
  Members members_;
  Settlement settlement_;
  [[no_unique_address]] PartIf<mechanisms::kSwitch, std::optional<LocalSwitches>> switches_;  // of a lone context
  [[no_unique_address]] PartIf<mechanisms::kSwitch, Switching> switching_;
  BoundarySignals signals_;
  [[no_unique_address]] PartIf<mechanisms::kRecovery, Recovery> recovery_;
};

}  // namespace chimera
