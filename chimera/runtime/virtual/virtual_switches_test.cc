// SPDX-License-Identifier: Apache-2.0
// A switch over several rtpus in virtual time: no cycle is lost, and tasks that stay are not disturbed.
#include "chimera/runtime/virtual/virtual_switches.h"

#include <gtest/gtest.h>

#include <vector>

#include "chimera/runtime/testing/switch_scene.h"
#include "chimera/runtime/testing/virtual_scene.h"

namespace chimera::virtual_switches_test {
namespace {

using namespace testing::switch_scene;
using testing::act_at;
using testing::VirtualScene;

struct VirtualSwitchesTest : ::testing::TestWithParam<bool> {
  /// Runs for `duration` with these acts. Returns the receipts.
  std::span<const SwitchReceipt> go(Nanoseconds duration, std::vector<ScriptAct> acts = {}) {
    rtpus.reset();
    rtpus = std::make_unique<VirtualScene>(application(0, false), std::move(acts), GetParam());
    rtpus->run(duration);
    return rtpus->receipts();
  }
  void SetUp() override { scene = {}; }
  void TearDown() override { rtpus.reset(); }

  std::unique_ptr<VirtualScene> rtpus;
};

INSTANTIATE_TEST_SUITE_P(All, VirtualSwitchesTest, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "Preemptive" : "Executive"; });

TEST_P(VirtualSwitchesTest, TwoRtpusChangeAtOneInstant) {
  const auto receipts = go(milliseconds(30), {act_at(microseconds(5600), ScriptAct::Kind::kSwitch, kObserved)});
  ASSERT_EQ(receipts.size(), 1u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[0].before, kDirect);
  EXPECT_EQ(receipts[0].asked, microseconds(5600));
  EXPECT_EQ(receipts[0].at, receipts[0].armed + microseconds(750)) << "three quarters of a period";
  EXPECT_EQ(receipts[0].tasks.size(), 6u);
  EXPECT_EQ(receipts[0].variables.size(), 2u);
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on one", "on observer", "on two", "off one"}));
  EXPECT_TRUE(rtpus->are_on(kSets[kObserved]));
  EXPECT_EQ(scene.illegal, 0);
  EXPECT_EQ(rtpus->lost(), 0u);
}

TEST_P(VirtualSwitchesTest, ATaskOfEitherRtpuAsksForTasks) {
  scene.in_reader = [](Cycle c) {
    if (c.count() == 5) c.request("--on two");  // the observer, which it reads, comes along
    if (c.count() == 10) c.request("--off plant");
  };
  scene.in_plant = [](Cycle c) {
    if (c.count() == 15) c.request("--on one --off observer two");
  };
  const auto receipts = go(milliseconds(30));
  ASSERT_EQ(receipts.size(), 2u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[0].by, kReader);
  EXPECT_EQ(receipts[0].after, kObserved);
  EXPECT_EQ(receipts[1].by, kPlant);
  EXPECT_EQ(receipts[1].after, kDirect);
  ASSERT_EQ(rtpus->asked().refused().size(), 1u);
  EXPECT_EQ(rtpus->asked().refused()[0].request.by, kReader);
  EXPECT_TRUE(rtpus->are_on(kSets[kDirect]));
  EXPECT_EQ(rtpus->lost(), 0u);
}

TEST_P(VirtualSwitchesTest, ALaterRequestForTheRunningSwitchTakesBackAnEarlierOne) {
  scene.in_plant = [](Cycle c) {
    if (c.count() == 6) c.request("beside");  // under way: observed
  };
  scene.in_reader = [](Cycle c) {
    if (c.count() == 6) c.request("observed");
    if (c.count() == 20) c.request("observed");  // in force
  };
  ScriptAct first = act_at(microseconds(5950), ScriptAct::Kind::kSwitch, kObserved);
  const auto receipts = go(milliseconds(30), {first});
  ASSERT_EQ(receipts.size(), 1u) << "the request of the second rtpu for the running switch replaces that of the first";
  EXPECT_TRUE(rtpus->are_on(kSets[kObserved]));
}

TEST_P(VirtualSwitchesTest, ADeathBeforeTheChangeAborts) {
  const auto receipts = go(milliseconds(30), {act_at(microseconds(5600), ScriptAct::Kind::kSwitch, kBeside),
                                              act_at(microseconds(5600), ScriptAct::Kind::kDie, 1)});
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kMemberDied);
  EXPECT_EQ(rtpus->state(kThree), State::kOff);
}

}  // namespace
}  // namespace chimera::virtual_switches_test
