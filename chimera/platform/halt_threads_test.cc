// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/halt.h"

#include <gtest/gtest.h>

#include <thread>

#include "chimera/platform/linux_clock.h"

namespace chimera {
namespace {

/// A thread that counts, inside open() .. close() or outside.
struct Counter {
  explicit Counter(bool is_open) : thread([this, is_open] { count(is_open); }) {
    while (counted == 0) std::this_thread::yield();
  }
  ~Counter() {
    halt.lift();
    quits = true;
    thread.join();
  }
  void count(bool is_open) {
    halt.attach();
    if (is_open) halt.open();
    while (!quits) {
      ++counted;
      LinuxClock().wait_until(LinuxClock().now() + microseconds(50));
    }
    halt.close();
  }
  // Counts no more for 20 ms.
  bool stands() const {
    const std::uint64_t before = counted;
    LinuxClock().wait_until(LinuxClock().now() + milliseconds(20));
    return counted == before;
  }
  bool comes_to(bool standing) const {
    const Nanoseconds until = LinuxClock().now() + seconds(10);
    while (stands() != standing)
      if (LinuxClock().now() > until) return false;
    return true;
  }

  Halt halt;
  std::atomic<std::uint64_t> counted{0};
  std::atomic<bool> quits{false};
  std::thread thread;
};

TEST(Halt, StopsAThreadUntilItIsLifted) {
  Counter one(true), other(true);
  for (int i = 0; i < 3; ++i) {
    one.halt.ask();
    EXPECT_TRUE(one.comes_to(true));
    EXPECT_TRUE(other.comes_to(false)) << "it may wait for a CPU; one that is halted stands for ever";
    one.halt.lift();
    EXPECT_TRUE(one.comes_to(false));
  }
}

TEST(Halt, DoesNotStopAThreadOutside) {
  Counter one(false);
  one.halt.ask();
  EXPECT_TRUE(one.comes_to(false));
}

TEST(Halt, StopsAtTheOpeningAThreadThatWasAskedBefore) {
  Halt halt;
  std::atomic<int> step{0};
  std::thread thread([&] {
    halt.attach();
    step = 1;
    while (step == 1) std::this_thread::yield();
    halt.open();
    step = 3;
    halt.close();
  });
  while (step == 0) std::this_thread::yield();
  halt.ask();
  step = 2;
  LinuxClock().wait_until(LinuxClock().now() + milliseconds(20));
  EXPECT_EQ(step, 2);
  halt.lift();
  thread.join();
  EXPECT_EQ(step, 3);
}

}  // namespace
}  // namespace chimera
