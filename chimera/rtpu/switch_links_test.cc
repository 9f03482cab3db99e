// SPDX-License-Identifier: Apache-2.0
// A switch over rtpus, stepped in virtual time. The new producer of the variable u of plant is in the same rtpu, in the
// other one, or a new task in the other one.
#include "chimera/rtpu/switch_links.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
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
  SwitchLinksTest() { make(); }
  void make() {
    scene = {};
    rtpus.reset();
    app = testing::switch_scene::application(limit, false);
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
  const TaskPart& part(std::uint32_t u, TaskId task) const {
    const SwitchPart& all = rtpus->part(u);
    const auto end = all.tasks.begin() + all.n_tasks;
    const auto found = std::find_if(all.tasks.begin(), end, [task](const TaskPart& p) { return p.task == task; });
    EXPECT_NE(found, end);
    return *found;
  }
  std::uint64_t lost() const {
    std::uint64_t n = 0;
    for (const auto& rtpu : rtpus->rtpus)
      for (const Task& task : rtpu->tasks->tasks()) n += task.profile.dropped + task.profile.missed;
    return n;
  }

  double limit = 0;
  std::unique_ptr<TestApplication> app;
  std::unique_ptr<TestRtpus> rtpus;
};

TEST_F(SwitchLinksTest, TwoRtpusChangeAtOneInstant) {
  const std::uint16_t number = rtpus->switch_to(kObserved);
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(0).number, number);
  EXPECT_EQ(rtpus->part(0).end, SwitchEnd::kDone);
  EXPECT_EQ(rtpus->part(1).end, SwitchEnd::kDone);
  EXPECT_EQ(rtpus->part(0).at, rtpus->part(1).at);
  EXPECT_TRUE(are_on(kSets[kObserved]));
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on observer", "on two", "off one"}));
  EXPECT_FALSE(rtpus->flag_is_up());
  EXPECT_EQ(scene.illegal, 0);
  EXPECT_EQ(lost(), 0u);
  EXPECT_EQ(rtpus->part(0).n_tasks, 3u);  // plant, beacon, observer
  EXPECT_EQ(rtpus->part(1).n_tasks, 3u);  // reader, one, two
  EXPECT_EQ(part(1, kOne).move, TaskMove::kLeaves);
  EXPECT_GE(part(1, kOne).off, Nanoseconds{});
  EXPECT_EQ(rtpus->part(1).n_variables, 1u);  // u; z goes to a task of the first rtpu
  EXPECT_TRUE(rtpus->part(1).variables[0].step_of_on.is_known);
}

TEST_F(SwitchLinksTest, ARequestStaysUntilTheManagerHandlesIt) {
  const auto wish = [&] { return rtpus->rtpus[1]->segment.block.head().wish.wish(); };
  std::string wanted = "direct";
  scene.in_reader = [&](Cycle c) { EXPECT_TRUE(c.request(wanted.c_str())); };
  rtpus->run(milliseconds(5));
  EXPECT_FALSE(wish().is_there()) << "it is in force";
  wanted = "observed";
  rtpus->run(milliseconds(5));
  EXPECT_EQ(wish(), (SwitchWish{1, kObserved, static_cast<std::uint16_t>(kReader.index), SwitchCause::kRequest}));
  EXPECT_NE(rtpus->rtpus[1]->segment.block.head().wish.read().at, Nanoseconds{});
  wanted = "direct";
  rtpus->run(milliseconds(5));
  EXPECT_EQ(wish().number, 2) << "it takes back the request that the manager has not handled";
  EXPECT_EQ(wish().set, kDirect);
  rtpus->manager->block.memory().wishes[1] = wish_dealt_with(1, 2);
  rtpus->run(milliseconds(5));
  EXPECT_EQ(wish().number, 2);
  wanted = "observed";
  rtpus->run(milliseconds(1));
  rtpus->manager->block.memory().wishes[1] = wish_dealt_with(1, 3);
  (void)rtpus->switch_to(kObserved);
  rtpus->run(milliseconds(10));
  EXPECT_TRUE(are_on(kSets[kObserved]));
  EXPECT_EQ(wish().number, 3) << "the running switch, in force later, is not requested again";
}

TEST_F(SwitchLinksTest, ARequestIsRepeatedThoughTheManagerOfTheLastIsDead) {
  const auto number = [&] { return rtpus->rtpus[1]->segment.block.head().wish.wish().number; };
  std::string wanted = "observed";
  scene.in_reader = [&](Cycle c) {
    EXPECT_TRUE(wanted.empty() || c.request(wanted.c_str()));
  };
  rtpus->run(milliseconds(1));
  ASSERT_EQ(number(), 1);
  wanted = "";
  rtpus->manager->block.memory().wishes[1] = wish_dealt_with(1, 1);
  (void)rtpus->switch_to(kObserved);
  rtpus->run(milliseconds(10));
  (void)rtpus->switch_to(kDirect);
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(are_on(kSets[kDirect]));
  rtpus->die(rtpus->n);
  wanted = "observed";
  rtpus->run(milliseconds(5));
  EXPECT_EQ(number(), 1) << "not yet: 100 ms have not passed since the last";
  rtpus->run(kAskAgain);
  EXPECT_EQ(number(), 2);
  EXPECT_EQ(rtpus->rtpus[1]->segment.block.head().wish.wish().set, kObserved);
}

TEST_F(SwitchLinksTest, TenThousandSwitchesDoNotDisturbTasksThatStay) {
  const Nanoseconds begin = rtpus->now;
  std::mt19937 random(5);
  std::vector<std::uint32_t> wanted;
  std::uint32_t at_present = kDirect;
  for (int i = 0; i < 10'000; ++i) {
    std::uint32_t next = random() % 2;
    if (next >= at_present) ++next;
    at_present = next;
    const std::uint16_t number = rtpus->switch_to(next, microseconds(300 + random() % 500));
    rtpus->run(microseconds(100 * (40 + random() % 20)));
    ASSERT_TRUE(rtpus->is_over(number)) << i;
    for (const std::uint32_t u : {0u, 1u}) {
      const SwitchPart& told = rtpus->part(u);
      ASSERT_EQ(told.number, number);
      ASSERT_EQ(told.end, SwitchEnd::kDone) << i << " " << static_cast<int>(told.why);
      for (std::uint32_t t = 0; t < told.n_tasks; ++t) ASSERT_EQ(told.tasks[t].lost, 0u) << i;
    }
    ASSERT_TRUE(are_on(kSets[at_present])) << i;
    ASSERT_FALSE(rtpus->flag_is_up());
  }
  EXPECT_EQ(scene.illegal, 0);
  EXPECT_EQ(lost(), 0u);
  const Nanoseconds passed = rtpus->now - begin;
  const Log plant = scene.plant, beacon = scene.beacon, u = scene.u, reader = scene.reader;
  make();
  rtpus->run(passed);
  EXPECT_TRUE(plant == scene.plant);
  EXPECT_TRUE(beacon == scene.beacon);
  EXPECT_TRUE(u == scene.u);
  EXPECT_TRUE(reader == scene.reader);
}

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

TEST_F(SwitchLinksTest, AStepOfOnBeyondTheLimitIsSeenAcrossRtpus) {
  limit = 0.5;
  make();
  scene.on_of_two = 0.6;
  const std::uint16_t number = rtpus->switch_to(kObserved);
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(1).why, NoSwitch::kStepTooLarge);
  EXPECT_TRUE(are_on(kSets[kDirect]));
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

TEST_F(SwitchLinksTest, TheDeathOfAMemberBeforeTheChangeAborts) {
  const std::uint16_t number = rtpus->switch_to(kBeside);
  rtpus->die(1);
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(0).end, SwitchEnd::kAborted);
  EXPECT_EQ(rtpus->part(0).why, NoSwitch::kMemberDied);
  EXPECT_EQ(state(kThree), State::kOff);
  EXPECT_TRUE(rtpus->flag_is_up());
}

// The rtpu of the leaving producer dies after all have agreed: the others do not wait for it.
TEST_F(SwitchLinksTest, TheDeathOfAMemberAfterTheCommitDoesNotHoldUpTheChange) {
  const std::uint16_t number = rtpus->switch_to(kBeside, milliseconds(5));
  SwitchAgreement agreement(rtpus->decision.switching, rtpus->keeper.origin);
  while (agreement.plan().phase != SwitchPhase::kCommitted) rtpus->run(microseconds(100));
  rtpus->die(1);
  rtpus->run(milliseconds(10));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(0).end, SwitchEnd::kDone);
  EXPECT_EQ(state(kThree), State::kOn);
  EXPECT_EQ(std::get<1>(scene.u.back()), 7);
}

TEST_F(SwitchLinksTest, ASuccessorAbortsASwitchOfItsPredecessor) {
  const std::uint16_t number = rtpus->switch_to(kBeside);
  rtpus->start(1, 2);
  rtpus->change();
  rtpus->run(milliseconds(20));
  ASSERT_TRUE(rtpus->is_over(number));
  EXPECT_EQ(rtpus->part(0).end, SwitchEnd::kAborted);
  EXPECT_EQ(rtpus->part(1).end, SwitchEnd::kAborted);
  EXPECT_EQ(state(kThree), State::kOff);
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
