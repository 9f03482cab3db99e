// SPDX-License-Identifier: Apache-2.0
// Where the present job of a task stands, between its release and its end.
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
//    kClaimed    it was ready; the claiming thread is in the section, changes it, and gives it back or cancels it
//    kCancelled  it was ready and never runs; its thread has not noticed yet
//    kRunning    the body runs, is preempted, halted or blocked
//    kEnded      the body (or method) is over; its thread raises its own level, which no other thread changes any more
//    kMethod     no job: the thread of the cycle boundary runs another method of the task
//
// try_begin, finish and end_method happen outside the section, every other move in it. A move from a phase from which
// it is not drawn ends the program; those that are tried, and acknowledge_cancel, do nothing then.
#pragma once

#include <atomic>
#include <cstdint>

namespace chimera {

/// The phase of the present job of one task: changed by the moves of the picture alone. Context of functions: cycle;
/// wait-free; in the section, unless said otherwise.
class JobPhase {
 public:
  enum Value : std::uint8_t { kIdle, kReady, kClaimed, kCancelled, kRunning, kEnded, kMethod };

  /// A job is released. Requires: kIdle.
  void release() noexcept { move(kIdle, kReady); }
  /// The thread has been dispatched. False: the job is claimed or cancelled, or the task now runs a method. In the
  /// section no thread has a job claimed, and false is final. Context: the thread itself; outside the section too.
  bool try_begin() noexcept { return try_move(kReady, kRunning); }
  /// Requires: kRunning. Context: the thread itself; outside the section.
  void finish() noexcept { move(kRunning, kEnded); }
  /// The thread has entered the section, at the ceiling: nothing is left of the job, or the method. Requires: kEnded.
  void retire() noexcept { move(kEnded, kIdle); }

  /// The job has not begun, and does not until it is given back; false: there is none, or it has begun.
  bool try_claim() noexcept { return try_move(kReady, kClaimed); }
  /// Given back: it may begin. Requires: kClaimed.
  void unclaim() noexcept { move(kClaimed, kReady); }
  /// It never begins. Requires: kClaimed.
  void cancel() noexcept { move(kClaimed, kCancelled); }
  /// The thread has noticed the cancel. No effect in other phases, since a method may run. Context: the thread itself.
  void acknowledge_cancel() noexcept { (void)try_move(kCancelled, kIdle); }

  /// The thread of the cycle boundary is about to run a method at the label of the task. Requires: is_free().
  void begin_method() noexcept;
  /// Requires: kMethod. Context: the thread of the cycle boundary; outside the section.
  void end_method() noexcept { move(kMethod, kEnded); }
  /// The thread has ended in the body, so another thread must report the end of the job. Requires: kRunning.
  void lose_thread() noexcept { move(kRunning, kIdle); }

  /// Context of questions: any.
  Value value() const noexcept { return value_.load(std::memory_order_acquire); }
  bool is_idle() const noexcept { return value() == kIdle; }
  bool is_ready() const noexcept { return value() == kReady; }
  bool is_running() const noexcept { return value() == kRunning; }
  bool has_ended() const noexcept { return value() == kEnded; }
  /// A cycle boundary may touch the task: no job or method of it is under way.
  bool is_free() const noexcept { return is_idle() || value() == kCancelled; }

 private:
  void move(Value from, Value to) noexcept;
  bool try_move(Value from, Value to) noexcept {
    return value_.compare_exchange_strong(from, to, std::memory_order_acq_rel, std::memory_order_acquire);
  }

  // unclaim() pairs with try_begin(): the thread sees how its job was changed. try_begin() pairs with value(): a thread
  // that sees kRunning sees JobThread::used_before(). finish() pairs with value(): a thread that sees kEnded leaves the
  // level alone.
  std::atomic<Value> value_{kIdle};
};

}  // namespace chimera
