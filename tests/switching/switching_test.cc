// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/switching/trial.h"

namespace chimera::switching_trial {
namespace {

TEST(SwitchingTrial, ReadersSeeOneProducerAndNoTaskStaysArmedAfterAnyMishap) {
  Tally all;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Tally one = run_trial(seed, 40);
    ASSERT_EQ(one.failure, "") << "seed " << seed;
    all.done += one.done;
    all.aborted += one.aborted;
    all.rtpu_deaths += one.rtpu_deaths;
    all.manager_deaths += one.manager_deaths;
    all.hold_ups += one.hold_ups;
    all.signals += one.signals;
  }
  EXPECT_GT(all.done, 1000u);
  EXPECT_GT(all.aborted, 200u);
  EXPECT_GT(all.rtpu_deaths, 100u);
  EXPECT_GT(all.manager_deaths, 50u);
  EXPECT_GT(all.hold_ups, 50u);
  EXPECT_GT(all.signals, 50u);
}

TEST(SwitchingTrial, ExecutivesAndPreemptiveRtpusSwitchTogetherInVirtualTime) {
  Tally all;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const Tally one = run_virtual_trial(seed, 20);
    ASSERT_EQ(one.failure, "") << "seed " << seed;
    all.done += one.done;
  }
  EXPECT_GT(all.done, 100u);
}

TEST(SwitchingTrial, ExchangedTasksOfALoopReadNoOldValue) {
  Tally all;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Tally one = run_loop_trial(seed, 20);
    ASSERT_EQ(one.failure, "") << "seed " << seed;
    all.done += one.done;
  }
  EXPECT_GT(all.done, 300u);
}

TEST(SwitchingTrial, SignalsOfPersonsDuringSwitchesNeverTurnTwoProducersOn) {
  Tally all;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Tally one = run_on_trial(seed, 100);
    ASSERT_EQ(one.failure, "") << "seed " << seed;
    all.done += one.done;
    all.aborted += one.aborted;
    all.signals += one.signals;
  }
  EXPECT_GT(all.done, 300u);
  EXPECT_GT(all.aborted, 10u);
  EXPECT_GT(all.signals, 100u);
}

}  // namespace
}  // namespace chimera::switching_trial
