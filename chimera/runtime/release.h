// SPDX-License-Identifier: Apache-2.0
// What every executor of one context does around a job: edges, releases, the failures of time and their reactions.
// Executors differ in two things only: how long a job takes and how they wait.
//
//   edge: script acts, signals            -> tasks join and leave the queue
//   release_due: releases                 -> ready queue; what is dropped is counted
//   may_start: last chance to say no      -> begin: inputs and body -> end: failures, publication, profile
//
// The three failures of time (Stewart & Khosla; docs/decisions/0003-releases-and-late-jobs.md) and what they see:
//   missed deadline    the job was not over at its deadline                                  on_miss
//   budget exceeded    it used more execution time than its budget                           on_overrun
//   minimum refused    at its start less than `min` was left before the deadline             on_miss
// Reactions: continue (a late result is published), hold (not published), skip (published; the next release is
// dropped), abort (the job is over at its deadline: not started after it, nothing published; in preemptive virtual
// time abandoned at that instant), error (the method error is called, nothing published), flag (published; the
// illegal-configuration flag goes up and stays up until it is lowered), stop (published; the executor stops), demote
// (from then on the job runs below all others; published).
// A refused minimum: continue and flag run the job all the same, the others do not start it.
//
// A job with a thread of its own is looked at when its deadline comes, and when its budget is used up: who is to blame
// is told then, and flag and stop act then. Else the job's end does that, as it does the rest in any case
// (docs/decisions/0017-late-jobs-are-told.md).
//
// A release that is dropped because jobs took too long is a missed deadline as well, in Profile::missed and towards
// max_consecutive; one that a reaction drops on purpose is not.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "chimera/base/fixed.h"
#include "chimera/runtime/blame.h"
#include "chimera/runtime/context_tap.h"
#include "chimera/runtime/cycle_step.h"
#include "chimera/runtime/edge_guest.h"
#include "chimera/runtime/job_threads.h"
#include "chimera/runtime/script.h"
#include "chimera/runtime/tap_ring.h"
#include "chimera/runtime/task_set.h"
#include "chimera/schedule/ready_queue.h"

namespace chimera {

/// How a context is to be run. What it points at outlives the executor.
struct RunOptions {
  Policy policy = Policy::kEdf;
  Script script;
  Tap* tap = nullptr;                        ///< null: nothing is recorded
  std::uint8_t rtpu = 0;                     ///< for the records
  EdgeGuest* guest = nullptr;                ///< null: nobody else takes part in the edges
  const std::atomic<bool>* stop = nullptr;   ///< looked at before every job; may be set by a signal handler
  JobThreads* threads = nullptr;             ///< null: jobs run where the edges do
  bool can_demote = false;                   ///< jobs may go on below all others
};

/// A signal that was refused, from the script or from a task.
struct RefusedSignal {
  Nanoseconds at;  ///< on the executor's clock
  TaskId task;
  Signal signal = Signal::kOn;
  Refusal why = Refusal::kNone;
  State state = State::kNotCreated;  ///< of the task, then
};

inline constexpr std::size_t kRefusedKept = 64;

/// Why a run ended.
enum class RunEnd : std::uint8_t {
  kTime,         ///< the stated time is over
  kStopped,      ///< RunOptions::stop was set
  kNothingLeft,  ///< no task is ON and no act or signal can change that
  kTaskStopped,  ///< the reaction `stop` of a task
};

/// The common half of all executors. Context of everything not marked: cycle; no allocation, no system call.
class Releases {
 public:
  /// Requires: no task of this context with the reaction switch, nor demote unless that can be done. Context: setup.
  Releases(TaskSet& set, const RunOptions& options);

  /// The grid of releases starts at `origin`; whoever is ON by now is released from there on. Context: edge.
  void begin(Nanoseconds origin) noexcept;
  Nanoseconds origin() const noexcept { return origin_; }

  /// True when something else than the next job may be due: an edge, a release, the end of the run. False for most
  /// jobs of a row. Whoever gets true looks at all of them and then calls rest().
  bool must_look(Nanoseconds now) const noexcept {
    return now >= calm_until_ || stop_requested() || (options_.guest != nullptr && options_.guest->is_due(now));
  }
  /// Everything that is due by now was looked at; the run ends at `until`.
  void rest(Nanoseconds until) noexcept {
    const bool is_calm = !set_.has_pending() && !task_stopped_;
    calm_until_ = is_calm ? std::min({queue_.next_release(), next_act_, until}) : kAtOnce;
  }
  /// The next must_look() is true.
  void look_again() noexcept { calm_until_ = kAtOnce; }
  /// True when take_edge has something to do.
  bool edge_is_due(Nanoseconds now) const noexcept {
    return set_.has_pending() || next_act_ <= now || (options_.guest != nullptr && options_.guest->is_due(now));
  }
  /// Carries out the acts and signals that are due; signals for a task with an unfinished job wait for its end.
  void take_edge(Nanoseconds now) noexcept;
  /// The next instant at which an edge or a release may be due.
  Nanoseconds next_event() const noexcept;
  /// The same for edges alone, where releases have threads of their own.
  Nanoseconds next_edge() const noexcept {
    return options_.guest == nullptr ? next_act_ : std::min(next_act_, options_.guest->next_due());
  }
  /// True while a task is ON or may yet be turned ON.
  bool anything_left() const noexcept {
    return n_on_ > 0 || set_.has_pending() || next_act_ != kNever || options_.guest != nullptr;
  }
  bool stop_requested() const noexcept {
    return options_.stop->load(std::memory_order_relaxed);
  }
  bool task_stopped() const noexcept { return task_stopped_; }
  /// The first task whose reaction was `stop`. Requires: task_stopped().
  TaskId stopped_by() const noexcept { return stopped_by_; }
  /// The reaction `stop` has been answered: the loop may go on. Context: edge.
  void forget_stop() noexcept { task_stopped_ = false; }

  /// For the guest, within take(): signals, recorded as they are carried out. Context: edge.
  SignalReport signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now) noexcept;
  SignalReport served(TaskId task, Nanoseconds now) noexcept;

  void release_due(Nanoseconds now) noexcept {
    if (queue_.next_release() > now) return;
    queue_.release_due(now, [this](const DroppedRelease& d) { drop(d); });
    if (patience_lost_) give_up_starved(now);
  }
  ReadyQueue& queue() noexcept { return queue_; }
  Task& task(TaskId id) noexcept { return tasks_[id.index]; }
  bool is_on(TaskId id) const noexcept { return of_[id.index].is_on; }
  /// May an edge touch the task now? Not while a job of it is under way. Context: edge.
  bool may_touch(TaskId id) noexcept {
    return options_.threads != nullptr ? options_.threads->claim(id) : !tasks_[id.index].is_busy;
  }

  /// False when the job must not start: its release is then counted as dropped, with all that follows.
  [[gnu::always_inline]] bool may_start(const Job& job, Nanoseconds now) noexcept {
    const OfTask& t = of_[job.task.index];
    if (tap_.is_on()) record_release(job);
    if (!t.skip_next && now + t.start_margin <= job.deadline) return true;
    const bool starts = decide_start(job, now);
    if (options_.threads == nullptr && t.wants.load(std::memory_order_relaxed) != 0) settle_job(job.task, now);
    return starts;
  }
  /// The illegal-configuration flag, to be read once for each job. Context: edge.
  bool is_illegal() const noexcept { return set_.is_illegal(); }
  /// Runs the body: inputs are read at this moment, nothing is published. `time` is for end().
  [[gnu::always_inline]] BodyEnd begin_job(const Job& job, CycleTime& time, bool illegal) noexcept {
    OfTask& t = of_[job.task.index];
    Task& task = *t.task;
    if (options_.threads == nullptr) {  // else whoever released the job has done so
      task.is_busy = true;
      t.told.store(0, std::memory_order_relaxed);
    }
    // Field by field: a copy of a fresh aggregate loads wider than it was stored, and waits for the store buffer.
    time.release = job.release;
    time.deadline = job.deadline;
    time.dropped = t.dropped;
    time.illegal = illegal;
    return cycle_step::begin(task, time);
  }
  /// The job ended at `end`, begun at `start`, having used `used` of execution time.
  [[gnu::always_inline]] void end_job(const Job& job, const CycleTime& time, BodyEnd body, Nanoseconds start,
                                      Nanoseconds end, Nanoseconds used) noexcept {
    OfTask& t = of_[job.task.index];
    Task& task = *t.task;
    task.is_busy = false;
    const bool in_time = end <= job.deadline && used <= t.budget;
    if (body.is_good() && in_time && t.is_plain && t.told.load(std::memory_order_relaxed) == 0) [[likely]] {
      count_times(task, job, start, end, used);
      task.profile.missed_in_a_row = 0;
      cycle_step::publish(task, time, end);
      t.dropped -= time.dropped;  // this cycle was told of those
      if (task.has_news || task.is_tapped) [[unlikely]] look_after(task);
    } else {
      conclude_job(job, time, body, start, end, used);
    }
    if (t.wants.load(std::memory_order_relaxed) != 0) settle_job(job.task, end);
  }
  /// The first half of end_job, which touches nothing but the task: failures of time, publication, error handling.
  /// Context: cycle, on the task's own thread.
  void conclude_job(const Job& job, const CycleTime& time, BodyEnd body, Nanoseconds start, Nanoseconds end,
                    Nanoseconds used) noexcept;
  /// What jobs of the task left for the others: the flag, signals sent, its state. Requires: none is under way.
  /// Context: edge.
  void settle_job(TaskId id, Nanoseconds now) noexcept;
  /// That part of it which does not wait for the end of a job: the flag, stop, who is to blame. Others may act
  /// meanwhile (Blame::judge): look at the task anew afterwards. Context: edge.
  void settle_at_once(TaskId id, Nanoseconds now) noexcept;
  bool is_unsettled(TaskId id) const noexcept { return of_[id.index].wants.load(std::memory_order_relaxed) != 0; }
  /// The job began and is abandoned at its deadline (reaction abort): counts the miss; end_job follows.
  void abandon(const Job& job) noexcept {
    want_blame(tasks_[job.task.index], job.release);
    count_miss(tasks_[job.task.index], job.deadline, {});
  }
  /// The job never started and its deadline has come (reaction abort).
  void expire_waiting(const Job& job) noexcept;

  /// The first kRefusedKept signals that were refused. Context: setup.
  std::span<const RefusedSignal> refused() const noexcept { return {refused_.begin(), refused_.end()}; }

  /// What happens is recorded here.
  ContextTap& tap() noexcept { return tap_; }

  /// A job of the task is released, of which nothing was told. Context: cycle, before anybody else knows of the job.
  void forget_told(TaskId task) noexcept { of_[task.index].told.store(0, std::memory_order_relaxed); }
  /// The deadline of the job has come and it is not over. Who is to blame is told, and where it has begun `flag` and
  /// `stop` act, unless the miss is tolerated; its end counts the miss. Once a job. Context: edge.
  void tell_late(const Job& job, bool has_begun) noexcept;
  /// The job of the task that is under way, its `cycle`-th, has used more than its budget: `flag` and `stop` act. False
  /// when that was told before. Context: edge.
  bool tell_overrun(TaskId task, std::uint64_t cycle, Nanoseconds used, Nanoseconds now) noexcept;
  bool is_told_late(TaskId task) const noexcept { return was_told(task, kLate); }
  bool is_told_overrun(TaskId task) const noexcept { return was_told(task, kOverrun); }

  /// A dropped release made some task's misses too many. Context: edge.
  bool has_lost_patience() const noexcept { return patience_lost_; }
  /// Ends those tasks: nobody else would, when others never let them start. Context: edge.
  void give_up_starved(Nanoseconds now) noexcept;
  /// A release that will not run for lack of time. Context: cycle, as may_start.
  void drop(const DroppedRelease& dropped) noexcept;

 private:
  static constexpr Nanoseconds kAtOnce{INT64_MIN};
  static constexpr std::atomic<bool> kNoStop{false};

  // Everything a job needs beside the Task, in one cache line.
  struct alignas(64) OfTask {
    Task* task = nullptr;
    Nanoseconds start_margin;  // a job starts while now + start_margin <= deadline
    Nanoseconds budget;        // kNever: none
    std::uint64_t told_seen = 0, faults_seen = 0;  // of what the task told, and of its faults
    std::uint32_t dropped = 0;  // since the last completed cycle
    bool skip_next = false;
    bool is_on = false;
    bool is_plain = true;  // no threads, nothing tolerated: a good job in time needs no judgement
    std::atomic<std::uint8_t> wants{0};  // of the others
    std::atomic<std::uint8_t> told{0};   // of the present job
    std::atomic<std::uint64_t> history{0};  // of the last cycles, one bit each: 1 missed
  };
  enum Wants : std::uint8_t { kSettle = 1, kRaiseFlag = 2, kStop = 4, kBlame = 8 };
  enum Told : std::uint8_t { kLate = 1, kWaitsLate = 2, kOverrun = 4, kEnded = 8 };  // kWaitsLate: before it began

  void record_release(const Job& job) noexcept;
  void drop_on_purpose(const DroppedRelease& dropped) noexcept;
  static bool is_out_of_patience(const Task& task) noexcept {
    const std::uint32_t limit = task.spec->max_consecutive;
    return limit > 0 && task.profile.missed_in_a_row >= limit;
  }
  void count_miss(Task& task, Nanoseconds at, Nanoseconds lateness) noexcept;
  bool was_told(TaskId task, int what) const noexcept {
    return (of_[task.index].told.load(std::memory_order_relaxed) & what) != 0;
  }
  bool tell(TaskId task, Told what) noexcept {
    return (of_[task.index].told.fetch_or(what, std::memory_order_acq_rel) & (what | kEnded)) == 0;
  }
  std::uint8_t end_telling(TaskId task) noexcept;
  void count_times(Task& task, const Job& job, Nanoseconds start, Nanoseconds end, Nanoseconds used) noexcept {
    if (blame_) blame_->ended(job.task, used, end);
    Profile& p = task.profile;
    p.execution[CHIMERA_CYCLE].add(used);
    p.response.add(end - job.release);
    p.start_delay.add(start - job.release);
  }
  void look_after(Task& task) noexcept;
  void want_at_once(const Task& task, OnMiss reaction) noexcept;
  bool decide_start(const Job& job, Nanoseconds now) noexcept;
  void want_blame(const Task& task, Nanoseconds release) noexcept {
    if (!blame_) return;
    blame_->missed(task.id, release);
    want(task, kBlame);
  }
  void tell_blame(TaskId missed, Nanoseconds now) noexcept;
  bool is_tolerated(const Task& task, std::uint64_t history) const noexcept;
  bool remember(Task& task, bool missed) noexcept;
  bool judge(Task& task, const Job& job, BodyEnd& body, Nanoseconds end, Nanoseconds used, std::uint8_t told) noexcept;
  bool react(OnMiss reaction, Task& task, BodyEnd& body, const char* why, Nanoseconds at) noexcept;
  void give_up(Task& task, Nanoseconds at) noexcept;
  void act(const ScriptAct& act, Nanoseconds now) noexcept;
  void look_at_script() noexcept {
    const Nanoseconds at = options_.script.next_at();
    next_act_ = at == kNever ? kNever : origin_ + at;
  }
  void carry_out(Task& task, Signal signal, Nanoseconds now) noexcept;
  void ring(Task& task, Nanoseconds now) noexcept;
  void record_signal(const SignalReport& report, bool was_illegal, Nanoseconds now) noexcept;
  void record_outcome(TaskId task, bool was_illegal, Nanoseconds now) noexcept;
  void refresh_members(Nanoseconds now) noexcept;
  void refresh(Task& task, Nanoseconds now) noexcept;
  void join(Task& task, Nanoseconds now) noexcept;
  void leave(Task& task) noexcept;
  void record_faults(Task& task) noexcept;
  void settle(Task& task, Nanoseconds now) noexcept;
  void raise_flag(TaskId by, Nanoseconds at) noexcept;
  void want(const Task& task, Wants what) noexcept {
    of_[task.id.index].wants.fetch_or(what, std::memory_order_relaxed);
  }

  TaskSet& set_;
  std::span<Task> tasks_;
  RunOptions options_;
  Nanoseconds origin_;
  Nanoseconds next_act_ = kNever;  ///< of the script, on the clock
  Nanoseconds calm_until_ = kAtOnce;
  std::vector<OfTask> of_;
  ContextTap tap_;
  std::optional<Blame> blame_;  // with a guest
  std::vector<QueueMember> members_;
  std::vector<QueueClass> classes_;
  std::vector<QueueTask> queue_tasks_;
  std::vector<LooseJob> loose_;
  std::vector<std::uint32_t> pauses_, runs_;
  ReadyQueue queue_;
  std::uint32_t n_on_ = 0;
  bool task_stopped_ = false;
  TaskId stopped_by_;
  FixedVector<RefusedSignal, kRefusedKept> refused_;
  bool patience_lost_ = false;  ///< by a dropped release: somebody may have missed too many
};

}  // namespace chimera
