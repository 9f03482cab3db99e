// SPDX-License-Identifier: Apache-2.0
// A switch over rtpus, stepped in virtual time. The new producer of the variable u of plant is in the same rtpu, in the
// other one, or a new task in the other one.
#include "chimera/rtpu/switch_links.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "chimera/rtpu/testing/test_rtpus.h"
#include "chimera/runtime/testing/switch_scene.h"

namespace chimera {
namespace {

using namespace testing::switch_scene;
using testing::TestApplication;
using testing::TestRtpus;

struct SwitchLinksTest : ::testing::Test {
  SwitchLinksTest() {
    scene = {};
    app = testing::switch_scene::application(0, false);
    rtpus = std::make_unique<TestRtpus>(*app);
    rtpus->run(milliseconds(1));
    for (std::uint32_t t = 0; t <= kThree.index; ++t) {
      rtpus->send(Signal::kSpawn, {TaskId(t)});
      rtpus->run(milliseconds(1));
    }
    for (const TaskId task : kSets[kDirect]) rtpus->send(Signal::kOn, {task});
    rtpus->run(milliseconds(10));
    scene.illegal = 0;
    scene.story.clear();
  }
  State state(TaskId task) const { return rtpus->rtpus[app->tasks[task.index].rtpu.index]->state(task); }
  bool are_on(const std::vector<TaskId>& set) const {
    for (std::uint32_t t = 0; t <= kThree.index; ++t)
      if ((state(TaskId(t)) == State::kOn) != (std::ranges::find(set, TaskId(t)) != set.end())) return false;
    return true;
  }
  std::uint64_t lost() const {
    std::uint64_t n = 0;
    for (const auto& rtpu : rtpus->rtpus)
      for (const Task& task : rtpu->tasks->tasks()) n += task.profile.dropped + task.profile.missed;
    return n;
  }

  std::unique_ptr<TestApplication> app;
  std::unique_ptr<TestRtpus> rtpus;
};

TEST_F(SwitchLinksTest, AnOnThatFailsInOneRtpuUndoesArmingInTheOther) {
  scene.on_of_two_fails = true;
  const std::uint16_t number = rtpus->switch_to(kObserved);
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(0).end, SwitchEnd::kAborted);
  EXPECT_EQ(rtpus->part(0).why, NoSwitch::kNone) << "the other rtpu aborted";
  EXPECT_EQ(rtpus->part(1).why, NoSwitch::kOnFailed);
  EXPECT_EQ(rtpus->part(1).task, kTwo);
  EXPECT_STREQ(rtpus->part(1).said, "no current");
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on observer", "on two", "off observer"}));
  EXPECT_TRUE(are_on(kSets[kDirect]));
  EXPECT_EQ(scene.illegal, 0);
}

TEST_F(SwitchLinksTest, ASignalToAMemberAborts) {
  const std::uint16_t number = rtpus->switch_to(kObserved);
  rtpus->send(Signal::kOff, {kOne});
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(1).end, SwitchEnd::kAborted);
  EXPECT_EQ(state(kOne), State::kOff);
  EXPECT_EQ(state(kTwo), State::kOff);
  EXPECT_EQ(state(kObserver), State::kOff);
  EXPECT_TRUE(rtpus->flag_is_up());  // u has no producer
}

TEST_F(SwitchLinksTest, AnOrderWithAChangedWordIsAborted) {
  const std::uint16_t number = rtpus->switch_to(kObserved);
  rtpus->decision.switching.order[3] ^= 4096;
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(0).why, NoSwitch::kDamaged);
  EXPECT_TRUE(are_on(kSets[kDirect]));
  EXPECT_EQ(scene.illegal, 0);
}

// Between its own agreement and the commit an rtpu still aborts if a task of the switch fails.
TEST_F(SwitchLinksTest, AFailureAfterItsOwnAgreementStillAborts) {
  (void)rtpus->switch_to(kObserved, milliseconds(20));
  testing::TestRtpu* agreed = nullptr;  // steps the rtpus one by one, until one has agreed and the other has not
  while (agreed == nullptr) {
    rtpus->now = rtpus->now + microseconds(100);
    for (const auto& rtpu : rtpus->rtpus) {
      (void)rtpu->executive->run(rtpus->now - rtpus->keeper.origin);
      const PlanWord plan = PlanWord::of(rtpus->decision.switching.plan);
      if (plan.phase == SwitchPhase::kProposed) agreed = rtpu.get();
      ASSERT_NE(plan.phase, SwitchPhase::kAborted);
      if (agreed != nullptr) break;
    }
  }
  agreed->tasks->flag().raise(true);
  rtpus->change();  // a cycle boundary
  rtpus->now = rtpus->now + microseconds(100);
  (void)agreed->executive->run(rtpus->now - rtpus->keeper.origin);
  EXPECT_EQ(PlanWord::of(rtpus->decision.switching.plan).phase, SwitchPhase::kAborted);
  rtpus->run(milliseconds(30));
  EXPECT_EQ(agreed->segment.block.switch_part().why, NoSwitch::kFlagRaised);
  EXPECT_TRUE(are_on(kSets[kDirect]));
}

TEST_F(SwitchLinksTest, WithoutTimeToAgreeItIsAborted) {
  const std::uint16_t number = rtpus->switch_to(kObserved, Nanoseconds{});
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(0).end, SwitchEnd::kAborted);
  EXPECT_TRUE(are_on(kSets[kDirect]));
  EXPECT_EQ(lost(), 0u);
  EXPECT_EQ(scene.illegal, 0);
}

}  // namespace
}  // namespace chimera
