// SPDX-License-Identifier: Apache-2.0
// Threads: SCHED_FIFO levels, execution time, rights, stacks, ordinary threads; Halt, which takes the processor from a
// thread; SwitchWatch, which notices that a thread lost its processor.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "chimera/base/time.h"

namespace chimera {

/// Number of the calling thread. Context: setup.
pid_t this_thread() noexcept;

/// The calling thread reads and writes numbers with a decimal point, whatever locale a component sets for the process.
/// Context: setup.
void use_decimal_point() noexcept;

/// Runs `thread` of this process (0: the calling thread) at that SCHED_FIFO level. A lowered thread goes to the head of
/// its new level, a raised thread to the tail (sched(7)). Threads and processes that `thread` starts are ordinary
/// (SCHED_RESET_ON_FORK); without CAP_SYS_NICE that flag cannot be taken back, so each change of a level sets it again.
/// False if the thread is gone or the right is missing. Context: cycle; wait-free (one system call).
bool set_level(pid_t thread, int level) noexcept;

/// Runs `thread` below every real-time thread (SCHED_OTHER). Context: cycle; wait-free (one system call).
bool set_below_all(pid_t thread) noexcept;

/// The level at which `thread` runs; 0 if `thread` is gone or no real-time thread. Context: cycle; wait-free (one
/// system call).
int level_of(pid_t thread) noexcept;

/// Execution time that `thread` of this process has used; kNever if the thread is gone. Context: cycle; wait-free (one
/// system call).
Nanoseconds used_by(pid_t thread) noexcept;

/// Execution time of the calling thread. Context: cycle; wait-free (one system call).
Nanoseconds used_by_this_thread() noexcept;

/// True if `thread` of this process waits in the kernel; false if the thread is gone. Context: cycle boundary; bounded
/// (reads a file of the kernel).
bool is_asleep(pid_t thread) noexcept;

/// How often the calling thread gave up its processor to wait, a wait for a page of memory included. Context: any;
/// wait-free (one system call).
std::uint64_t sleeps_of_this_thread() noexcept;

/// Policies of the Linux scheduler.
inline constexpr int kPolicyOther = 0, kPolicyFifo = 1, kPolicyRoundRobin = 2;

/// The real-time rights of a thread of any process.
struct ThreadRights {
  pid_t thread = 0;
  int policy = 0, level = 0;  ///< policy: kPolicyOther, kPolicyFifo..., without SCHED_RESET_ON_FORK
  int only_cpu = -1;          ///< the one CPU that the thread may run on; -1: several
  bool operator==(const ThreadRights&) const noexcept = default;
};

/// False if there is no such thread. Context: setup.
bool look_up_rights(pid_t thread, ThreadRights& rights) noexcept;

/// Starts a thread without real-time rights, on any CPU, whatever rights the calling thread has. The thread blocks all
/// signals and is detached. False if the system grants no thread. Context: setup.
bool start_ordinary_thread(std::function<void()> work);

/// Sets the stack size of threads that start during its lifetime: the default of the process, restored at the end.
/// One at a time. Context: setup.
class ThreadStack {
 public:
  /// `bytes` 0: no change.
  explicit ThreadStack(std::size_t bytes) noexcept;
  ThreadStack(const ThreadStack&) = delete;
  ThreadStack& operator=(const ThreadStack&) = delete;
  ~ThreadStack();

 private:
  std::size_t before_ = 0;
};

/// Stops a thread in the middle of a computation until lift(): for a thread whose share of the processor is used up.
/// Lowering the level of the thread would not stop it: on an idle processor the thread would still run.
///
///   thread:  attach() | open() | computes | close()          others:  ask() ... lift()
///
/// ask() sends the thread a signal (SIGRTMIN + 5), whose handler sleeps on a word. Outside open() .. close() the
/// handler does not sleep: a halted thread never holds a lock from there. The signal restarts system calls
/// (SA_RESTART). The object outlives the work of the thread after attach().
class Halt {
 public:
  /// Installs the handler of the signal. Context: setup.
  Halt() noexcept;
  Halt(const Halt&) = delete;
  Halt& operator=(const Halt&) = delete;

  /// The calling thread is the thread to halt. Context: setup.
  void attach() noexcept;
  /// From here on the thread sleeps between ask() and lift(); at once after an earlier ask(). Context: cycle; the
  /// thread itself; blocks.
  void open() noexcept;
  /// From here on the thread does not sleep. Context: cycle; the thread itself; wait-free.
  void close() noexcept { (void)word_.fetch_and(~kOpen, std::memory_order_release); }

  /// The thread stops where it would next run. Context: cycle; wait-free (one system call).
  void ask() noexcept;
  /// The thread may go on. Context: cycle; wait-free (one system call).
  void lift() noexcept;

 private:
  static constexpr std::uint32_t kOpen = 1, kAsked = 2;

  static void handle(int) noexcept;
  void sleep() noexcept;

  // Other threads call ask() and lift(), the thread itself open() and close(), all with release; the acquire of
  // sleep(), in the signal handler of the thread, pairs with lift().
  std::atomic<std::uint32_t> word_{0};
  pid_t thread_ = 0;
};

/// Says without a system call whether the calling thread kept its processor for a while. Then the elapsed time is its
/// execution time, more exact than the clock of the execution time, whose reading is a system call. Not nested.
///
///   begin() | computes | end(): true if the thread kept its processor
///
/// SwitchWatch rests on restartable sequences (linux/rseq.h, `rseq_cs`): when the kernel takes the processor from a
/// thread, or hands a signal to the thread, it clears the sequence that the thread has named, unless the thread is
/// inside of the sequence. SwitchWatch names a sequence of no instructions. If the code between begin() and end() uses
/// such sequences itself, end() reports a switch.
class SwitchWatch {
 public:
  /// True if this system supports the watch. Tried once, by falling asleep. Context: setup; blocks some microseconds.
  static bool can_tell() noexcept;
  /// Starts the watch. Requires: can_tell(). Context: cycle; wait-free.
  static void begin() noexcept;
  /// True if since begin() the thread was not preempted, did not sleep and got no signal. Context: cycle; wait-free.
  static bool end() noexcept;
};

}  // namespace chimera
