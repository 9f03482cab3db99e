// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/switch_watch.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <thread>
#include <vector>

#include "chimera/platform/linux_clock.h"
#include "chimera/platform/processor_level.h"

namespace chimera {
namespace {

class ASwitchWatch : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!SwitchWatch::can_tell()) GTEST_SKIP() << "this system has no restartable sequences";
  }
};

void stay_on_this_processor() {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
}

Nanoseconds compute(Nanoseconds time) {
  const Nanoseconds start = LinuxClock().now();
  Nanoseconds now = start;
  while (now < start + time) now = LinuxClock().now();
  return now - start;
}

// Some microseconds are nearly always one's own; a hundred times not, never.
TEST_F(ASwitchWatch, SeesNothingWhereNothingCameBetween) {
  bool kept = false;
  for (int i = 0; i < 100 && !kept; ++i) {
    SwitchWatch::begin();
    (void)compute(microseconds(10));
    kept = SwitchWatch::end();
  }
  EXPECT_TRUE(kept);
}

TEST_F(ASwitchWatch, SystemCallsThatDoNotSleepAreNoSwitches) {
  bool kept = false;
  for (int i = 0; i < 100 && !kept; ++i) {
    SwitchWatch::begin();
    (void)used_by_this_thread();
    kept = SwitchWatch::end();
  }
  EXPECT_TRUE(kept);
}

TEST_F(ASwitchWatch, SeesASleep) {
  for (int i = 0; i < 20; ++i) {
    SwitchWatch::begin();
    (void)LinuxClock().wait_until(LinuxClock().now() + microseconds(50));
    EXPECT_FALSE(SwitchWatch::end());
  }
}

// Both are on one processor: who sees the other's count grow lost it meanwhile.
TEST_F(ASwitchWatch, SeesThatAnotherThreadHadTheProcessor) {
  stay_on_this_processor();
  std::atomic<std::uint64_t> count{0};
  std::atomic<bool> over{false};
  std::thread other([&] {
    while (!over) ++count;
  });
  for (int i = 0; i < 10; ++i) {
    SwitchWatch::begin();
    for (const std::uint64_t before = count; count == before;) {
    }
    EXPECT_FALSE(SwitchWatch::end());
  }
  over = true;
  other.join();
}

TEST_F(ASwitchWatch, SeesASignal) {
  struct sigaction ignore_it {};
  struct sigaction before {};
  ignore_it.sa_handler = [](int) {};
  ASSERT_EQ(sigaction(SIGUSR2, &ignore_it, &before), 0);
  SwitchWatch::begin();
  (void)raise(SIGUSR2);
  EXPECT_FALSE(SwitchWatch::end());
  ASSERT_EQ(sigaction(SIGUSR2, &before, nullptr), 0);
}

TEST_F(ASwitchWatch, EndsOnce) {
  SwitchWatch::begin();
  (void)SwitchWatch::end();
  EXPECT_FALSE(SwitchWatch::end());
}

// The claim it is used for: what passed is what was used.
TEST_F(ASwitchWatch, WhereItSeesNothingTimePassedAndTimeUsedAgree) {
  stay_on_this_processor();
  std::vector<std::int64_t> differences;
  for (int i = 0; i < 400; ++i) {
    const Nanoseconds before = used_by_this_thread();
    SwitchWatch::begin();
    const Nanoseconds passed = compute(microseconds(200));
    if (SwitchWatch::end()) differences.push_back((used_by_this_thread() - before - passed).count);
  }
  ASSERT_GT(differences.size(), 10u);
  std::sort(differences.begin(), differences.end());
  EXPECT_NEAR(static_cast<double>(differences[differences.size() / 2]), 0, 20'000);
}

}  // namespace
}  // namespace chimera
