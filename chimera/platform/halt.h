// SPDX-License-Identifier: Apache-2.0
// Takes a thread off its processor in the middle of what it computes, until it is let go on: what a share of the
// processor that is used up asks for. Lowering its level would not do: it would run on wherever nobody else does.
//
//   thread:  attach() | open() | computes | close()          others:  ask() ... lift()
//
// ask() sends the thread a signal (kHaltSignal), whose handler sleeps on a word. Outside open() .. close() it does not
// sleep, so whatever is locked there is never kept by a thread that is halted.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <csignal>
#include <cstdint>

namespace chimera {

/// The signal that belongs to this; system calls that it interrupts are taken up again where they can be.
inline int halt_signal() noexcept { return SIGRTMIN + 5; }

/// One thread's. Outlives what the thread does between attach() and its end.
class Halt {
 public:
  /// Installs the handler of the signal. Context: setup.
  Halt() noexcept;
  Halt(const Halt&) = delete;
  Halt& operator=(const Halt&) = delete;

  /// The calling thread is the one. Context: setup.
  void attach() noexcept;
  /// From here on the thread sleeps while it is asked to; so it does at once when it was. Context: cycle; the thread
  /// itself; blocks.
  void open() noexcept;
  /// No more. Context: cycle; the thread itself; wait-free.
  void close() noexcept { (void)word_.fetch_and(~kOpen, std::memory_order_release); }

  /// It is to stop. It takes effect when the thread would next run. Context: cycle; wait-free (one system call).
  void ask() noexcept;
  /// It may go on. Context: cycle; wait-free (one system call).
  void lift() noexcept;

 private:
  static constexpr std::uint32_t kOpen = 1, kAsked = 2;

  static void handle(int) noexcept;
  void sleep() noexcept;

  // ask() and lift() by others, open() and close() by the thread, all with release; the acquire of sleep(), in the
  // thread's signal handler, pairs with lift().
  std::atomic<std::uint32_t> word_{0};
  pid_t thread_ = 0;
};

}  // namespace chimera
