// SPDX-License-Identifier: Apache-2.0
// A switch over several rtpus in virtual time: no cycle is lost, and tasks that stay are not disturbed.
#include "chimera/runtime/virtual/virtual_switches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
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
    rtpus = std::make_unique<VirtualScene>(application(limit, false), std::move(acts), GetParam());
    rtpus->run(duration);
    return rtpus->receipts();
  }
  void SetUp() override { scene = {}; }
  void TearDown() override { rtpus.reset(); }

  double limit = 0;
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

TEST_P(VirtualSwitchesTest, AThousandSwitchesDoNotDisturbTasksThatStay) {
  std::vector<ScriptAct> acts;
  std::mt19937 random(3);
  Nanoseconds at = milliseconds(10);
  std::uint32_t present = kDirect;
  for (int i = 0; i < 1'000; ++i) {
    present = static_cast<std::uint32_t>((present + 1 + random() % 2) % 3);
    acts.push_back(act_at(at, ScriptAct::Kind::kSwitch, present));
    at += microseconds(5000) + Nanoseconds{static_cast<std::int64_t>(random() % 2000000)};
  }
  const Nanoseconds end = at + milliseconds(20);
  go(end);
  const Log plant = scene.plant, beacon = scene.beacon, u = scene.u, reader = scene.reader;
  scene = {};
  const auto receipts = go(end, acts);
  ASSERT_EQ(receipts.size(), acts.size());
  std::uint32_t n = 0;
  for (const SwitchReceipt& receipt : receipts) {
    ASSERT_EQ(receipt.number, ++n);
    ASSERT_EQ(receipt.end, SwitchEnd::kDone) << n << " for " << static_cast<int>(receipt.why);
    for (const TaskPart& part : receipt.tasks) ASSERT_EQ(part.lost, 0u) << n;
  }
  EXPECT_TRUE(rtpus->are_on(kSets[present]));
  EXPECT_EQ(rtpus->lost(), 0u);
  EXPECT_EQ(scene.illegal, 0);
  EXPECT_TRUE(plant == scene.plant);
  EXPECT_TRUE(beacon == scene.beacon);
  EXPECT_TRUE(u == scene.u);
  EXPECT_TRUE(reader == scene.reader);
}

TEST_P(VirtualSwitchesTest, ATaskOfEitherRtpuAsks) {
  scene.in_reader = [](Cycle c) {
    if (c.count() == 5) c.request("observed");
  };
  scene.in_plant = [](Cycle c) {
    if (c.count() == 15) c.request("beside");
  };
  const auto receipts = go(milliseconds(30));
  ASSERT_EQ(receipts.size(), 2u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[0].cause, SwitchCause::kRequest);
  EXPECT_EQ(receipts[0].by, kReader);
  EXPECT_EQ(receipts[0].after, kObserved);
  EXPECT_GE(receipts[0].asked, milliseconds(5));
  EXPECT_LE(receipts[0].asked, milliseconds(6));
  EXPECT_EQ(receipts[1].by, kPlant);
  EXPECT_EQ(receipts[1].before, kObserved);
  EXPECT_TRUE(rtpus->are_on(kSets[kBeside]));
  EXPECT_EQ(rtpus->lost(), 0u);
  EXPECT_EQ(scene.illegal, 0);
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

// Two tasks request a switch in each cycle. Receipts are kept while there is room.
TEST_P(VirtualSwitchesTest, RequestsInEveryCycleFillNoMemory) {
  scene.in_reader = [](Cycle c) { c.request(c.count() % 10 < 5 ? "observed" : "beside"); };
  scene.in_plant = [](Cycle c) { c.request(c.count() % 10 < 5 ? "observed" : "beside"); };
  const auto receipts = go(seconds(1));
  EXPECT_EQ(receipts.size(), 16u);
  EXPECT_GT(rtpus->rtpus().receipts().left_out(), 50u);
  for (const SwitchReceipt& receipt : receipts.first(15)) EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(rtpus->lost(), 0u);
}

TEST_P(VirtualSwitchesTest, ARequestForTheSetInForceOrAnUnknownSetLeavesNoReceipt) {
  scene.in_reader = [](Cycle c) {
    if (c.count() == 5) c.request("nowhere");
    if (c.count() == 6) c.request("direct");
  };
  const auto receipts = go(milliseconds(30));
  EXPECT_EQ(receipts.size(), 0u);
  EXPECT_EQ(rtpus->set(1).tasks()[kReader.index].requests_refused, 1);
}

TEST_P(VirtualSwitchesTest, AFailureOnOneRtpuIsUndoneOnTheOther) {
  scene.on_of_two_fails = true;
  const auto receipts = go(milliseconds(30), {act_at(microseconds(5600), ScriptAct::Kind::kSwitch, kObserved)});
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kOnFailed);
  EXPECT_EQ(receipts[0].task, kTwo);
  EXPECT_EQ(receipts[0].said.view(), "no current");
  EXPECT_TRUE(rtpus->are_on(kSets[kDirect]));
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on one", "on observer", "on two", "off observer"}));
}

TEST_P(VirtualSwitchesTest, ADeathBeforeTheChangeAborts) {
  const auto receipts = go(milliseconds(30), {act_at(microseconds(5600), ScriptAct::Kind::kSwitch, kBeside),
                                              act_at(microseconds(5600), ScriptAct::Kind::kDie, 1)});
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kMemberDied);
  EXPECT_EQ(rtpus->state(kThree), State::kOff);
}

TEST_P(VirtualSwitchesTest, OneAtATime) {
  const auto receipts = go(milliseconds(30), {act_at(microseconds(5600), ScriptAct::Kind::kSwitch, kObserved),
                                              act_at(microseconds(5700), ScriptAct::Kind::kSwitch, kBeside),
                                              act_at(milliseconds(20), ScriptAct::Kind::kSwitch, kObserved)});
  ASSERT_EQ(receipts.size(), 3u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[1].why, NoSwitch::kUnderWay);
  EXPECT_EQ(receipts[2].end, SwitchEnd::kNothingToDo);
}

}  // namespace
}  // namespace chimera::virtual_switches_test
