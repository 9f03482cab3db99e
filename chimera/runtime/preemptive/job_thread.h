// SPDX-License-Identifier: Apache-2.0
// One task of a preemptive context, its thread, and its present job.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"
#include "chimera/runtime/preemptive/job_phase.h"
#include "chimera/runtime/preemptive/sporadic_thread.h"
#include "chimera/schedule/ready_queue.h"
#include "chimera/task/task.h"

namespace chimera {

/// The public members are written in the section. The thread of the task also reads `job` and `is_illegal` while its
/// job runs; no thread writes them then. Context of functions: cycle; wait-free; in the section, unless said otherwise.
class JobThread {
 public:
  /// Context: setup.
  explicit JobThread(Task& owner) noexcept;

  /// Starts the thread, which runs `body`. Context: setup; may block.
  template <class Body>
  void start(Body body) {
    thread_ = std::thread(body);
  }
  /// Context: setup; the thread itself.
  void attach() noexcept;
  /// Context: setup; blocks until the thread has ended.
  void join() { thread_.join(); }
  pid_t thread() const noexcept { return thread_id_; }
  /// Ends the wait of the thread. Context: any.
  void wake() noexcept;
  /// Returns a count of rings. If it is read before the check for work, a wait with it loses no wake(). Context: the
  /// thread itself.
  std::uint32_t heard() const noexcept { return bell_.read(); }
  /// Waits for wake() since `heard`, at most until `instant`. Context: the thread itself; outside the section; blocks.
  void wait(std::uint32_t heard, Nanoseconds instant) noexcept { (void)bell_.wait_until(heard, instant); }

  /// Notes that all execution time used up to now belongs to earlier jobs. Context: the thread itself; outside the
  /// section.
  void begin_use() noexcept { used_before_.store(used_by_this_thread().count, std::memory_order_relaxed); }
  /// The execution time of earlier jobs. Context: any.
  Nanoseconds used_before() const noexcept { return Nanoseconds{used_before_.load(std::memory_order_relaxed)}; }
  /// Execution time of the job that runs, or hangs; zero if its thread is gone.
  Nanoseconds used() const noexcept;
  /// The next release is not held, and no run ends before it.
  bool takes_release() const noexcept { return next_release < release_end; }
  /// The newest release of its grid that is taken by `now`. Requires: takes_release(); next_release <= now.
  Nanoseconds newest_release(Nanoseconds now) const noexcept {
    const Nanoseconds newest = std::min(now, release_end - Nanoseconds{1});
    return next_release + spec.period * ((newest - next_release) / spec.period);
  }

  /// The method that a job of the task runs now: cycle, sync or error. Context: any.
  Method method() const noexcept { return std::atomic_ref(task.job_method).load(std::memory_order_relaxed); }

  /// From here on the job has the processor, as far as can be told. kNever: it has not had the processor yet.
  /// Context: any.
  void begin_slice(Nanoseconds now) noexcept { slice_.store(now.count, std::memory_order_relaxed); }
  /// No effect if the job was preempted, and went on, since its thread read the clock. Context: the thread itself;
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
  pid_t carrier = 0;  ///< the thread that runs at the label of the task: its own, or that of the cycle boundaries

  Nanoseconds next_release = kNever;  ///< kNever: the task is not ON, or no event has come
  Nanoseconds release_end = kNever;   ///< releases at this instant and later are not taken
  bool is_on = false;                 ///< as far as the thread knows
  bool is_held = false;               ///< no job begins until a cycle boundary has checked the task
  bool is_awaited = false;            ///< a cycle boundary found a job under way and comes again at its end

  JobPhase phase;           ///< of the present job; also moved outside the section, where JobPhase says so
  Job job;                  ///< the present one
  std::uint64_t cycle = 0;  ///< its number, as it was released
  bool is_illegal = false;  ///< the illegal-configuration flag, as it was then
  bool is_demoted = false;  ///< runs below all others

  Nanoseconds shown_at;  ///< when the profile of the task was last shown
  bool is_shown = true;  ///< the profile has not changed since

 private:
  std::thread thread_;
  pid_t thread_id_ = 0;
  std::atomic<std::uint32_t> bell_word_{0};  // pairs with itself: Doorbell::ring() and read()
  Doorbell bell_{bell_word_, Ringers::kThisProcess};
  std::atomic<std::int64_t> used_before_{0};  // written by the thread before phase.try_begin(), which publishes it
  std::atomic<std::int64_t> slice_{kNever.count};  // pairs with nothing: only where a record begins depends on it
};

}  // namespace chimera
