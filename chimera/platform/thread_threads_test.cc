// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/thread.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>

#include <atomic>
#include <future>
#include <thread>

#include "chimera/base/testing/await.h"
#include "chimera/platform/clock.h"

namespace chimera::thread_threads_test {
namespace {

struct Seen {
  int policy = -1, cpus = 0;
  bool takes_signals = true;
};

Seen look() {
  Seen seen{.policy = ::sched_getscheduler(0)};
  cpu_set_t set;
  ::sched_getaffinity(0, sizeof set, &set);
  seen.cpus = CPU_COUNT(&set);
  sigset_t mask;
  ::pthread_sigmask(SIG_BLOCK, nullptr, &mask);
  seen.takes_signals = ::sigismember(&mask, SIGTERM) == 0;
  return seen;
}

TEST(OrdinaryThread, RunsOnAnyCpuAndBlocksSignalsWhenItsMakerIsBoundToOneCpu) {
  const Seen before = look();
  std::promise<Seen> seen;
  std::thread([&] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(::sched_getcpu()), &one);
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
    ASSERT_TRUE(start_ordinary_thread([&seen] { seen.set_value(look()); }));
  }).join();
  const Seen found = seen.get_future().get();
  EXPECT_EQ(found.policy, SCHED_OTHER);
  EXPECT_GE(found.cpus, before.cpus);
  EXPECT_FALSE(found.takes_signals);
}

/// A thread that counts, inside or outside of open() .. close().
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
  // The thread counts nothing for 20 ms.
  bool stands() const {
    const std::uint64_t before = counted;
    LinuxClock().wait_until(LinuxClock().now() + milliseconds(20));
    return counted == before;
  }
  bool comes_to(bool standing) const {
    return await_that([&] { return stands() == standing; });
  }

  Halt halt;
  std::atomic<std::uint64_t> counted{0};
  std::atomic<bool> quits{false};
  std::thread thread;
};

TEST(Halt, StopsAThreadUntilLift) {
  Counter one(true), other(true);
  for (int i = 0; i < 3; ++i) {
    one.halt.ask();
    EXPECT_TRUE(one.comes_to(true));
    EXPECT_TRUE(other.comes_to(false)) << "this thread may wait for a CPU; a halted thread stands forever";
    one.halt.lift();
    EXPECT_TRUE(one.comes_to(false));
  }
}

TEST(Halt, DoesNotStopAThreadOutsideOfOpenAndClose) {
  Counter one(false);
  one.halt.ask();
  EXPECT_TRUE(one.comes_to(false));
}

TEST(Halt, StopsAThreadAtOpenAfterAnEarlierAsk) {
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
}  // namespace chimera::thread_threads_test
