// SPDX-License-Identifier: Apache-2.0
// One task of a preemptive context, its thread, and where its present job stands.
//
//             release           try_begin             finish            retire
//    kIdle ------------> kReady ----------> kRunning ---------> kEnded ---------> kIdle
//    |  ^                |    ^                |                   ^
//    |  |       try_claim|    |unclaim         +--lose_thread--> kIdle
//    |  |                v    |                                    |
//    |  |               kClaimed                                   |
//    |  |                  |cancel                                 |
//    |  |acknowledge_cancel v                                      |
//    |  +--------------- kCancelled ----+                          |
//    |                                  |begin_method              |
//    +----------------------------------+------> kMethod ----------+
//                                                      end_method
//
//    kIdle       no job; the thread sleeps, or is on its way to
//    kReady      the job is in the ready list and its thread lowered; it has not been dispatched yet
//    kClaimed    it was ready; who claimed it is in the section, changes it, and gives it back or cancels it
//    kCancelled  it was ready and never runs; its thread has not noticed yet
//    kRunning    the body runs, is preempted, halted or blocked
//    kEnded      the body (or method) is over; whoever ran it raises its own level, which nobody else changes any more
//    kMethod     no job: the thread of the edge runs another method of the task
//
// try_begin, finish and end_method happen outside the section, every other move in it. A move from a phase from which
// it is not drawn ends the program; those that are tried, and acknowledge_cancel, do nothing then.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

#include "chimera/platform/doorbell.h"
#include "chimera/platform/processor_level.h"
#include "chimera/runtime/preemptive/sporadic_thread.h"
#include "chimera/schedule/ready_queue.h"
#include "chimera/task/task.h"

namespace chimera {

enum class JobPhase : std::uint8_t { kIdle, kReady, kClaimed, kCancelled, kRunning, kEnded, kMethod };

/// The public members are written in the section; the thread of the task also reads `job` and `is_illegal` while its
/// job runs, when nobody writes them. Context of functions: cycle; wait-free; in the section, unless said otherwise.
class JobThread {
 public:
  /// Context: setup.
  explicit JobThread(Task& owner) noexcept;

  /// A job is released. Requires: kIdle.
  void release() noexcept { move(JobPhase::kIdle, JobPhase::kReady); }
  /// The thread has been dispatched; false: the job is claimed or cancelled, or the task runs a method by now. In the
  /// section nobody has a job claimed, and false is final. Context: the thread itself; outside the section too.
  bool try_begin() noexcept { return try_move(JobPhase::kReady, JobPhase::kRunning); }
  /// Requires: kRunning. Context: the thread itself; outside the section.
  void finish() noexcept { move(JobPhase::kRunning, JobPhase::kEnded); }
  /// The thread has entered the section, at the ceiling: nothing is left of the job, or the method. Requires: kEnded.
  void retire() noexcept { move(JobPhase::kEnded, JobPhase::kIdle); }

  /// The job has not begun, and does not until it is given back; false: there is none, or it has begun.
  bool try_claim() noexcept { return try_move(JobPhase::kReady, JobPhase::kClaimed); }
  /// Given back: it may begin. Requires: kClaimed.
  void unclaim() noexcept { move(JobPhase::kClaimed, JobPhase::kReady); }
  /// It never begins. Requires: kClaimed.
  void cancel() noexcept { move(JobPhase::kClaimed, JobPhase::kCancelled); }
  /// The thread knows by now; no effect in other phases, for a method may run by then. Context: the thread itself.
  void acknowledge_cancel() noexcept { (void)try_move(JobPhase::kCancelled, JobPhase::kIdle); }

  /// The thread of the edge is about to run a method at the label of the task. Requires: is_free().
  void begin_method() noexcept;
  /// Requires: kMethod. Context: the thread of the edge; outside the section.
  void end_method() noexcept { move(JobPhase::kMethod, JobPhase::kEnded); }
  /// The thread has ended in the body: nobody else says that the job is over. Requires: kRunning.
  void lose_thread() noexcept { move(JobPhase::kRunning, JobPhase::kIdle); }

  JobPhase phase() const noexcept { return phase_.load(std::memory_order_acquire); }
  bool is_idle() const noexcept { return phase() == JobPhase::kIdle; }
  bool is_ready() const noexcept { return phase() == JobPhase::kReady; }
  bool is_running() const noexcept { return phase() == JobPhase::kRunning; }
  bool has_ended() const noexcept { return phase() == JobPhase::kEnded; }
  /// An edge may touch the task: nothing of it is under way.
  bool is_free() const noexcept { return is_idle() || phase() == JobPhase::kCancelled; }

  /// What the thread runs, from here on. Context: setup; may block.
  template <class Body>
  void start(Body body) {
    thread_ = std::thread(body);
  }
  /// Context: setup; the thread itself.
  void attach() noexcept;
  /// Context: setup; blocks until the thread has ended.
  void join() { thread_.join(); }
  pid_t thread() const noexcept { return thread_id_; }
  /// Ends what the thread waits for. Context: any.
  void wake() noexcept;
  /// To be read before looking at what a wait would be for: no wake() is lost. Context: the thread itself.
  std::uint32_t heard() const noexcept { return bell_.read(); }
  /// Waits for wake() since `heard`, at most until `instant`. Context: the thread itself; outside the section; blocks.
  void wait(std::uint32_t heard, Nanoseconds instant) noexcept { (void)bell_.wait_until(heard, instant); }

  /// What the thread has used by now is that of earlier jobs. Context: the thread itself; outside the section.
  void begin_use() noexcept { used_before_.store(used_by_this_thread().count, std::memory_order_relaxed); }
  /// The execution time of earlier jobs. Context: any.
  Nanoseconds used_before() const noexcept { return Nanoseconds{used_before_.load(std::memory_order_relaxed)}; }
  /// Execution time of the job that runs, or hangs; zero when its thread is gone.
  Nanoseconds used() const noexcept;
  /// What a job of the task runs now: sync or cycle. Context: any.
  Method method() const noexcept {
    return std::atomic_ref(task.in_sync).load(std::memory_order_relaxed) ? Method::kSync : Method::kCycle;
  }

  /// From here on the job has the processor, as far as can be told. kNever: it has not had the processor yet.
  /// Context: any.
  void begin_slice(Nanoseconds now) noexcept { slice_.store(now.count, std::memory_order_relaxed); }
  /// No effect when the job was preempted, and went on, since its thread read the clock. Context: the thread itself;
  /// outside the section.
  void begin_first_slice(Nanoseconds now) noexcept {
    std::int64_t none = kNever.count;
    (void)slice_.compare_exchange_strong(none, now.count, std::memory_order_relaxed);
  }
  Nanoseconds slice() const noexcept { return Nanoseconds{slice_.load(std::memory_order_relaxed)}; }

  Task& task;
  const TaskSpec& spec;
  const TaskId id;
  std::optional<SporadicThread> sporadic;  ///< of a task behind a server
  pid_t carrier = 0;  ///< who runs at the label of the task: its thread, or that of the edges

  Nanoseconds next_release = kNever;  ///< kNever: the task is not ON, or no event has come
  bool is_on = false;                 ///< as far as the thread was told
  bool is_held = false;               ///< no job begins until an edge has looked at the task
  bool is_awaited = false;            ///< an edge found a job under way and comes again at its end

  Job job;                  ///< the present one
  std::uint64_t cycle = 0;  ///< its number, as it was released
  bool is_illegal = false;  ///< the illegal-configuration flag, as it was then
  bool is_demoted = false;  ///< runs below all others

  Nanoseconds shown_at;  ///< when the profile of the task was last handed out
  bool is_shown = true;  ///< that was the profile as it is

 private:
  void move(JobPhase from, JobPhase to) noexcept;
  bool try_move(JobPhase from, JobPhase to) noexcept {
    return phase_.compare_exchange_strong(from, to, std::memory_order_acq_rel, std::memory_order_acquire);
  }

  std::thread thread_;
  pid_t thread_id_ = 0;
  std::atomic<std::uint32_t> bell_word_{0};  // pairs with itself: Doorbell::ring() and read()
  Doorbell bell_{bell_word_, Ringers::kThisProcess};
  // unclaim() pairs with try_begin(): the thread sees how its job was changed. try_begin() pairs with phase(): who sees
  // kRunning sees used_before_. finish() pairs with phase(): who sees kEnded leaves the level alone.
  std::atomic<JobPhase> phase_{JobPhase::kIdle};
  std::atomic<std::int64_t> used_before_{0};  // written by the thread before try_begin(), which publishes the value
  std::atomic<std::int64_t> slice_{kNever.count};  // pairs with nothing: only where a record begins depends on it
};

}  // namespace chimera
