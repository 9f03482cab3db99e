// SPDX-License-Identifier: Apache-2.0
// A slow switch over two rtpus in virtual time: its steps in one order, and the way back, also when an rtpu dies.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "chimera/runtime/testing/tool_scene.h"
#include "chimera/runtime/testing/virtual_scene.h"

namespace chimera::virtual_slow_switches_test {
namespace {

using namespace testing::tool_scene;
using testing::act_at;
using testing::VirtualScene;

struct VirtualSlowSwitches : ::testing::TestWithParam<bool> {
  /// Runs for `duration` with these acts. Returns the receipts.
  std::span<const SwitchReceipt> go(Nanoseconds duration, std::vector<ScriptAct> acts) {
    rtpus.reset();
    rtpus = std::make_unique<VirtualScene>(application(1), std::move(acts), GetParam());
    rtpus->run(duration);
    return rtpus->receipts();
  }
  void SetUp() override { shop = {}; }
  void TearDown() override { rtpus.reset(); }

  std::unique_ptr<VirtualScene> rtpus;
};

INSTANTIATE_TEST_SUITE_P(All, VirtualSlowSwitches, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "Preemptive" : "Executive"; });

TEST_P(VirtualSlowSwitches, UsersOnBothRtpusAreReinitialisedInOrder) {
  const auto receipts = go(milliseconds(40), {act_at(milliseconds(5), ScriptAct::Kind::kSwitch, 1),
                                              act_at(milliseconds(25), ScriptAct::Kind::kSwitch, 0)});
  ASSERT_EQ(receipts.size(), 2u);
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone) << static_cast<int>(receipts[0].why);
  ASSERT_EQ(receipts[1].end, SwitchEnd::kDone) << static_cast<int>(receipts[1].why);
  EXPECT_EQ(shop.story, (std::vector<std::string>{"on light", "off light", "reinit arm", "reinit law", "on heavy",
                                                  "off heavy", "reinit arm", "reinit law", "on light"}));
  EXPECT_EQ(receipts[0].way.slow, kSlowForConstants);
  EXPECT_EQ((std::vector<TaskId>{receipts[0].reinitialised.begin(), receipts[0].reinitialised.end()}),
            (std::vector<TaskId>{kArm, kLaw}));
  EXPECT_GE(receipts[0].flag, milliseconds(1));
  EXPECT_LE(receipts[0].flag, milliseconds(10));
  EXPECT_GE(shop.illegal + shop.illegal_of_law, 2);
  EXPECT_EQ(*std::ranges::max_element(shop.weighed), 3);
  EXPECT_EQ(shop.weighed.back(), 1);
  EXPECT_TRUE(rtpus->are_on(kSets[kWithLight]));
  EXPECT_FALSE(rtpus->peers().is_flag_up());
}

// Light cycles on after the flag is up, until the arm has acted on it: its last cycle counts.
TEST_P(VirtualSlowSwitches, TheStepFromATaskOfAnotherRtpuIsFromItsLastCycle) {
  shop.ramp = 1;
  rtpus = std::make_unique<VirtualScene>(
      application(0), std::vector<ScriptAct>{act_at(milliseconds(5), ScriptAct::Kind::kSwitch, 1)}, GetParam());
  rtpus->run(milliseconds(40));
  const SwitchReceipt& receipt = rtpus->receipts()[0];
  ASSERT_EQ(receipt.end, SwitchEnd::kDone) << static_cast<int>(receipt.why);
  ASSERT_EQ(receipt.variables.size(), 1u);
  EXPECT_EQ(receipt.variables[0].step_of_on.size, 0) << "heavy takes over the last value of light";
  EXPECT_EQ(receipt.variables[0].usual.size, 1);
}

TEST_P(VirtualSlowSwitches, AFailureOnOneRtpuIsUndoneOnBoth) {
  shop.fails = "on heavy";
  const auto receipts = go(milliseconds(40), {act_at(milliseconds(5), ScriptAct::Kind::kSwitch, 1)});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kOnFailed);
  EXPECT_EQ(receipts[0].task, kHeavy);
  EXPECT_EQ(receipts[0].said.view(), "no");
  EXPECT_EQ(shop.story, (std::vector<std::string>{"on light", "off light", "reinit arm", "reinit law", "on heavy",
                                                  "reinit arm", "reinit law", "on light"}));
  EXPECT_EQ(shop.weighed.back(), 1);
  EXPECT_TRUE(rtpus->are_on(kSets[kWithLight]));
  EXPECT_FALSE(receipts[0].not_back.is_valid());
  EXPECT_FALSE(rtpus->peers().is_flag_up());
}

// The second rtpu dies at each tenth of a millisecond of the switch: living rtpus end with the constants of one side.
TEST_P(VirtualSlowSwitches, LivingRtpusAgreeOnOneSideWhenTheOtherDies) {
  for (std::int64_t us = 0; us < 5000; us += 100) {
    shop = {};
    const auto receipts = go(milliseconds(20), {act_at(milliseconds(5), ScriptAct::Kind::kSwitch, 1),
                                                act_at(microseconds(5001 + us), ScriptAct::Kind::kDie, 1)});
    const bool is_done = receipts[0].end == SwitchEnd::kDone;
    ASSERT_TRUE(is_done || receipts[0].end == SwitchEnd::kAborted) << us;
    EXPECT_TRUE(is_done || receipts[0].why == NoSwitch::kMemberDied) << us;
    EXPECT_EQ(shop.weighed.back(), is_done ? 3 : 1) << us;
    EXPECT_EQ(rtpus->state(kArm), State::kOn);
    EXPECT_TRUE(rtpus->peers().is_flag_up()) << "no task produces grip";
    EXPECT_FALSE(rtpus->set(0).flag().is_held());
  }
}

}  // namespace
}  // namespace chimera::virtual_slow_switches_test
