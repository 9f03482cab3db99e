// SPDX-License-Identifier: Apache-2.0
// Interface of the part that acts at the cycle boundaries of an executor: it brings signals and news of other
// processes.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/runtime/job/miss_cause.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/task_word.h"

namespace chimera {

class BoundarySignals;

/// Rings a bell or names an instant to ask for a cycle boundary. Used by the executor's thread only.
class BoundaryListener {
 public:
  /// True if take() has something to do. Context: cycle; wait-free.
  bool is_due(Nanoseconds now) const noexcept {
    return bell_->load(std::memory_order_relaxed) != heard_ || now >= due_;
  }
  Nanoseconds next_due() const noexcept { return due_; }
  /// Count of rings at the last take(). A wait that starts from it misses no later ring. Context: cycle boundary;
  /// wait-free.
  std::uint32_t heard() const noexcept { return heard_; }

  /// Deals with the inputs that are due: what comes from other processes. Signals are carried out by `signals`; what
  /// they change is listed in TaskSet::changes(), and published by publish(). Context: cycle boundary.
  virtual void take(BoundarySignals& signals, Nanoseconds now) noexcept = 0;
  /// Shows other processes what is listed in TaskSet::changes(), and clears the list. Called at the end of every cycle
  /// boundary, and after jobs that left something to settle. Context: cycle boundary.
  virtual void publish() noexcept = 0;
  /// A signal that a task of this context sent to one of this context was carried out or refused. Context: cycle
  /// boundary.
  virtual void told(const SignalReport& report, Nanoseconds now) noexcept = 0;
  /// The task missed a deadline, maybe with a job that is under way; the verdict says why. Context: cycle boundary.
  virtual void missed(TaskId task, const MissCause::Verdict& verdict, Nanoseconds now) noexcept = 0;
  /// A job does not end by itself: `job` is its task and method, `age` the time since its release; zero: its thread is
  /// gone. `used`: its execution time if that is beyond most_use(); zero: it sleeps. Context: cycle boundary.
  virtual void hangs(TaskWord job, Nanoseconds age, Nanoseconds used, Nanoseconds now) noexcept = 0;
  /// Jobs here used `used` of the time that the kernel looks back to, about all it lets real-time threads have: one of
  /// the task went on below all others. Context: cycle boundary.
  virtual void gave_way(TaskId task, Nanoseconds used, Nanoseconds now) noexcept = 0;
  /// The task went ON in place of `from`; `after`: time since this context found the loss. Context: cycle boundary.
  virtual void took_over(TaskId /*task*/, TaskId /*from*/, Nanoseconds /*after*/, Nanoseconds /*now*/) noexcept {}
  /// A job of the task is over, or its state changed, and its numbers may be shown. Context: cycle boundary.
  virtual void show(const Task& task) noexcept = 0;

 protected:
  explicit BoundaryListener(const std::atomic<std::uint32_t>& bell) noexcept : bell_(&bell) {}
  ~BoundaryListener() = default;
  void listen() noexcept { heard_ = bell_->load(std::memory_order_acquire); }  // pairs with Doorbell::ring()
  void set_due(Nanoseconds due) noexcept { due_ = due; }

 private:
  const std::atomic<std::uint32_t>* bell_;
  std::uint32_t heard_ = 0;
  Nanoseconds due_ = kNever;
};

}  // namespace chimera
