// SPDX-License-Identifier: Apache-2.0
// A slow switch over two rtpus in virtual time: its steps in one order, and the way back, also when a unit dies.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/tool_scene.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"

namespace chimera {
namespace {

using namespace testing::tool_scene;

ScriptAct act_at(Nanoseconds at, ScriptAct::Kind kind, std::uint32_t set = 0) {
  ScriptAct act;
  act.at = at;
  act.kind = kind;
  act.set = set;
  act.rtpu = RtpuId(1u);
  return act;
}

struct VirtualSlowSwitches : ::testing::TestWithParam<bool> {
  /// A run of so long with these acts; its receipts.
  std::span<const SwitchReceipt> go(Nanoseconds duration, std::vector<ScriptAct> acts) {
    run.reset();
    sets.clear();
    acts_ = std::move(acts);
    app = testing::tool_scene::application(1);
    peers = *VirtualPeers::create(app->spec);
    for (std::uint32_t r = 0; r < 2; ++r) {
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers.get();
      sets.push_back(*HeapTaskSet::create(app->spec, app->components, place));
      peers->join(RtpuId(r), *sets.back());
    }
    RunOptions options;
    options.script = Script(acts_);
    VirtualOptions how;
    how.preemptive = GetParam();
    run = std::make_unique<VirtualRtpus>(*peers, options, how);
    EXPECT_TRUE(run->start());
    EXPECT_EQ(run->run(duration), RunEnd::kTime);
    return run->receipts().all();
  }
  bool are_on(const std::vector<TaskId>& set) const {
    for (std::uint32_t t = 0; t <= kLaw.index; ++t)
      if ((peers->state(TaskId(t)) == State::kOn) != (std::ranges::find(set, TaskId(t)) != set.end())) return false;
    return true;
  }
  void SetUp() override { shop = {}; }
  void TearDown() override { run.reset(); }

  std::vector<ScriptAct> acts_;
  std::unique_ptr<testing::TestApplication> app;
  std::unique_ptr<VirtualPeers> peers;
  std::vector<std::unique_ptr<HeapTaskSet>> sets;
  std::unique_ptr<VirtualRtpus> run;
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
  EXPECT_TRUE(are_on(kSets[kWithLight]));
  EXPECT_FALSE(peers->is_flag_up());
}

TEST_P(VirtualSlowSwitches, WhatFailsOnOneRtpuIsUndoneOnBoth) {
  shop.fails = "on heavy";
  const auto receipts = go(milliseconds(40), {act_at(milliseconds(5), ScriptAct::Kind::kSwitch, 1)});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kOnFailed);
  EXPECT_EQ(receipts[0].task, kHeavy);
  EXPECT_EQ(receipts[0].said.view(), "no");
  EXPECT_EQ(shop.story, (std::vector<std::string>{"on light", "off light", "reinit arm", "reinit law", "on heavy",
                                                  "reinit arm", "reinit law", "on light"}));
  EXPECT_EQ(shop.weighed.back(), 1);
  EXPECT_TRUE(are_on(kSets[kWithLight]));
  EXPECT_FALSE(receipts[0].not_back.is_valid());
  EXPECT_FALSE(peers->is_flag_up());
}

// The second rtpu dies at each tenth of a millisecond of the switch: what lives ends with the constants of one side.
TEST_P(VirtualSlowSwitches, WhoeverDiesWhoLivesComesToOneSide) {
  for (std::int64_t us = 0; us < 5000; us += 100) {
    shop = {};
    const auto receipts = go(milliseconds(20), {act_at(milliseconds(5), ScriptAct::Kind::kSwitch, 1),
                                                act_at(microseconds(5001 + us), ScriptAct::Kind::kDie)});
    const bool is_done = receipts[0].end == SwitchEnd::kDone;
    ASSERT_TRUE(is_done || receipts[0].end == SwitchEnd::kAborted) << us;
    EXPECT_TRUE(is_done || receipts[0].why == NoSwitch::kMemberDied) << us;
    EXPECT_EQ(shop.weighed.back(), is_done ? 3 : 1) << us;
    EXPECT_EQ(peers->state(kArm), State::kOn);
    EXPECT_TRUE(peers->is_flag_up()) << "nobody produces grip";
    EXPECT_FALSE(sets[0]->flag().is_held());
  }
}

}  // namespace
}  // namespace chimera
