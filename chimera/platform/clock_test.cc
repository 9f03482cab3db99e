// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/clock.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace chimera {
namespace {

TEST(VirtualClock, WaitStepsToTheInstant) {
  VirtualClock clock(milliseconds(5));
  EXPECT_EQ(clock.now(), milliseconds(5));
  EXPECT_EQ(clock.wait_until(milliseconds(9)), WaitEnd::kReached);
  EXPECT_EQ(clock.now(), milliseconds(9));
  clock.advance(milliseconds(2));
  EXPECT_EQ(clock.now(), milliseconds(11));
}

TEST(VirtualClock, ReachesAnInstantInThePastAtOnce) {
  VirtualClock clock(milliseconds(5));
  EXPECT_EQ(clock.wait_until(milliseconds(4)), WaitEnd::kReached);
  EXPECT_EQ(clock.now(), milliseconds(5));
}

TEST(LinuxClock, IsNotBeforeTheInstantItReached) {
  LinuxClock clock;
  const Nanoseconds start = clock.now();
  for (int i = 1; i <= 20; ++i) {
    const Nanoseconds instant = start + microseconds(200) * i;
    EXPECT_EQ(clock.wait_until(instant), WaitEnd::kReached);
    EXPECT_GE(clock.now(), instant);
  }
  EXPECT_EQ(clock.wait_until(start), WaitEnd::kReached);
  EXPECT_EQ(clock.wait_until(Nanoseconds{-1}), WaitEnd::kReached);
}

TEST(LinuxClock, HandledSignalEndsTheWait) {
  struct sigaction action {};
  action.sa_handler = [](int) {};
  struct sigaction before {};
  ASSERT_EQ(::sigaction(SIGUSR1, &action, &before), 0);
  std::atomic<bool> ended{false};
  WaitEnd end = WaitEnd::kReached;
  std::thread waiter([&] {
    LinuxClock clock;
    end = clock.wait_until(clock.now() + milliseconds(60'000));
    ended = true;
  });
  while (!ended) {  // again and again: the first signal may come before the wait
    ::pthread_kill(waiter.native_handle(), SIGUSR1);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  waiter.join();
  EXPECT_EQ(end, WaitEnd::kWoken);
  ::sigaction(SIGUSR1, &before, nullptr);
}

TEST(WallClockShift, LeadsFromTheMonotonicClockToTheWallClock) {
  constexpr std::int64_t kSlew = 1'000'000;  // ns that NTP may move one clock between two readings
  const auto wall = [] { return std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1); };
  const std::int64_t before = wall();
  const std::int64_t shifted = wall_clock_shift() + LinuxClock().now().count;
  EXPECT_GE(shifted, before - kSlew);
  EXPECT_LE(shifted, wall() + kSlew);
}

}  // namespace
}  // namespace chimera
