// SPDX-License-Identifier: Apache-2.0
// The manager's side of a switch; the test plays the real-time units.
#include "chimera/manager/switch_coordinator.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstring>

#include "chimera/manager/testing/fake_subsystem.h"

namespace chimera::manager {
namespace {

constexpr std::uint32_t kRun = 0, kRest = 1;

struct SwitchCoordinatorTest : ::testing::Test {
  SwitchCoordinatorTest() {
    fake.start_manager();
    EXPECT_TRUE(fake.until_on("law"));
  }
  SwitchCoordinator& coordinator() { return fake.driver().switches(); }
  SwitchAgreement agreement() { return {fake.driver().world().page.switching, fake.driver().world().keeper.origin}; }
  void ask(std::uint32_t set) {
    got.reset();
    coordinator().ask({set, SwitchCause::kScript, {}}, "operate", seconds(10), now(),
                      [this](const SwitchOutcome& outcome) { got = outcome; });
  }
  SwitchPart& part(std::uint32_t r) { return fake.rtpu(r).block().switch_part(); }
  /// The unit has done what it has to do.
  void over(std::uint32_t r, NoSwitch why = NoSwitch::kNone) {
    part(r).number = agreement().plan().number;
    part(r).why = why;
    fake.rtpu(r).block().head().switching.adopted = part(r).number;
    fake.rtpu(r).block().head().switching.over = part(r).number;
  }
  void commit() {
    const std::uint16_t number = agreement().plan().number;
    ASSERT_TRUE(agreement().propose(number, agreement().round_up(now() + milliseconds(1))));
    EXPECT_FALSE(agreement().agree(number, 0));
    ASSERT_TRUE(agreement().agree(number, 1));
  }
  bool until_answered() {
    return fake.until([this] { return got.has_value(); });
  }

  FakeSubsystem fake;
  std::optional<SwitchOutcome> got;
};

TEST_F(SwitchCoordinatorTest, OrdersWhatIsAskedForAndPutsThePartsTogether) {
  ask(kRest);
  ASSERT_FALSE(got);
  const PlanWord plan = agreement().plan();
  EXPECT_EQ(plan.phase, SwitchPhase::kPrepared);
  const auto order = agreement().order(plan, fake.spec().sets.size(), fake.spec().tasks.size());
  ASSERT_TRUE(order);
  EXPECT_EQ(order->number, 1);
  EXPECT_EQ(order->members, 0b11);
  EXPECT_EQ(order->after, kRest);
  EXPECT_GE(order->lead, milliseconds(1));
  for (const char* name : {"sensor", "filter", "law"}) EXPECT_TRUE(order->on.has(fake.task(name))) << name;
  EXPECT_EQ(coordinator().under_way(), "switch 1 to 'rest', asked for by operate");
  commit();
  part(0).tasks[0] = {fake.task("sensor"), TaskMove::kStays, Nanoseconds{-1}, Nanoseconds{-1}, 0};
  part(0).tasks[1] = {fake.task("filter"), TaskMove::kLeaves, Nanoseconds{-1}, microseconds(7), 2};
  part(0).n_tasks = 2;
  part(1).tasks[0] = {fake.task("law"), TaskMove::kLeaves, Nanoseconds{-1}, microseconds(8), 0};
  part(1).n_tasks = 1;
  over(0);
  EXPECT_TRUE(fake.step());
  EXPECT_FALSE(got) << "the other unit is not over";
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(got->receipt.number, 1u);
  EXPECT_EQ(got->receipt.before, kRun);
  EXPECT_EQ(got->receipt.at, agreement().at(agreement().plan()));
  ASSERT_EQ(got->tasks.size(), 3u);
  EXPECT_EQ(got->tasks[0].task, fake.task("filter"));
  EXPECT_EQ(got->tasks[0].lost, 2u);
  EXPECT_FALSE(coordinator().is_under_way());
  EXPECT_NE(fake.told("switch").find("switch 1 to 'rest', asked for by operate: begun\n"), std::string::npos);
  EXPECT_NE(fake.told("switch").find("0 tasks arrive, 2 leave, 2 cycles lost\n"), std::string::npos);
}

TEST_F(SwitchCoordinatorTest, WhatIsInForceIsNothingToDo) {
  ask(kRun);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->receipt.end, SwitchEnd::kNothingToDo);
  EXPECT_EQ(agreement().plan().number, 0);
}

TEST_F(SwitchCoordinatorTest, ATaskInErrorIsNamed) {
  ask(kRest);
  commit();
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  fake.rtpu(1).fail(fake.task("law"), "as told");
  ASSERT_TRUE(fake.until([&] { return fake.driver().world().state(fake.task("law")) == State::kError; }));
  ask(kRun);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->receipt.end, SwitchEnd::kRefused);
  EXPECT_EQ(got->receipt.why, NoSwitch::kInError);
  EXPECT_EQ(got->receipt.task, fake.task("law"));
}

TEST_F(SwitchCoordinatorTest, OneAtATimeAndItCanBeCancelled) {
  ask(kRest);
  std::optional<SwitchOutcome> second;
  coordinator().ask({kRest, SwitchCause::kScript, {}}, "configure", seconds(1), now(),
                      [&](const SwitchOutcome& outcome) { second = outcome; });
  ASSERT_TRUE(second);
  EXPECT_EQ(second->receipt.why, NoSwitch::kUnderWay);
  EXPECT_EQ(second->under_way, "switch 1 to 'rest', asked for by operate");
  EXPECT_TRUE(coordinator().cancel());
  EXPECT_FALSE(coordinator().cancel());
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kAborted);
  EXPECT_EQ(got->receipt.why, NoSwitch::kCancelled);
}

TEST_F(SwitchCoordinatorTest, TheUnitThatAbortedSaysWhy) {
  ask(kRest);
  ASSERT_TRUE(agreement().abort(1));
  over(0);
  part(1).task = fake.task("law");
  std::strcpy(part(1).said, "no current");
  over(1, NoSwitch::kOnFailed);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.why, NoSwitch::kOnFailed);
  EXPECT_EQ(got->receipt.task, fake.task("law"));
  EXPECT_EQ(got->receipt.said.view(), "no current");
}

TEST_F(SwitchCoordinatorTest, OneThatWasOnlyLateIsTriedThreeTimes) {
  ask(kRest);
  Nanoseconds lead;
  for (std::uint16_t number = 1; number <= 3; ++number) {
    ASSERT_TRUE(fake.until([&] { return agreement().plan().number == number && agreement().plan().is_open(); }));
    const auto order = agreement().order(agreement().plan(), 2, 3);
    EXPECT_GT(order->lead, lead) << "each try has more time";
    lead = order->lead;
    EXPECT_FALSE(got);
    ASSERT_TRUE(agreement().abort(number));
    over(0, NoSwitch::kLate);
    over(1);
  }
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.why, NoSwitch::kLate);
  EXPECT_EQ(agreement().plan().number, 3);
}

TEST_F(SwitchCoordinatorTest, AFailureCountsMoreThanLateness) {
  ask(kRest);
  ASSERT_TRUE(agreement().abort(1));
  over(0, NoSwitch::kLate);
  over(1, NoSwitch::kOnFailed);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.why, NoSwitch::kOnFailed);
}

TEST_F(SwitchCoordinatorTest, WhatIsCancelledIsNotTriedAgain) {
  ask(kRest);
  EXPECT_TRUE(coordinator().cancel());
  over(0, NoSwitch::kLate);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.why, NoSwitch::kCancelled);
  EXPECT_EQ(agreement().plan().number, 1);
}

// Its manager is dead, and so may be the units: nobody else would close it.
TEST_F(SwitchCoordinatorTest, ASuccessorClosesAPlanThatIsPastItsDeadline) {
  coordinator().ask({kRest, SwitchCause::kScript, {}}, "operate", milliseconds(1), now(),
                    [](const SwitchOutcome&) {});
  fake.kill_manager();
  fake.start_manager();
  ASSERT_TRUE(fake.until_on("law"));
  ask(kRest);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->receipt.why, NoSwitch::kUnderWay);
  EXPECT_EQ(got->under_way, "a switch that a manager before this one has ordered");
  ASSERT_TRUE(fake.until([&] { return agreement().plan().phase == SwitchPhase::kAborted; }));
  over(0);
  over(1);
  ask(kRest);
  EXPECT_FALSE(got);
  EXPECT_EQ(agreement().plan().number, 2);
}

// The memory of a unit may hold anything.
TEST_F(SwitchCoordinatorTest, APartThatDoesNotFitTheApplicationIsLeftOut) {
  ask(kRest);
  commit();
  std::memset(static_cast<void*>(part(0).tasks.data()), 0xff, sizeof part(0).tasks);
  std::memset(static_cast<void*>(part(0).variables.data()), 0xff, sizeof part(0).variables);
  std::memset(part(0).said, 'x', sizeof part(0).said);
  part(0).n_tasks = part(0).n_variables = UINT32_MAX;
  part(0).task = TaskId(77u);
  part(1).tasks[0] = {fake.task("sensor"), TaskMove::kStays, Nanoseconds{-1}, Nanoseconds{-1}, 0};  // of the other unit
  part(1).n_tasks = 1;
  over(0, NoSwitch::kOnFailed);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kDone);
  EXPECT_TRUE(got->tasks.empty());
  EXPECT_TRUE(got->variables.empty());
}

// It would have turned law OFF: with what its last words say, law would come back.
TEST_F(SwitchCoordinatorTest, AUnitThatDiesBetweenCommitAndChangeComesBackToTheSetAfterIt) {
  ask(kRest);
  commit();
  fake.kill_rtpu(1, SIGKILL);
  over(0);
  fake.rtpu(0).block().set_status(fake.task("filter"), {State::kOff, false, 1});
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kDone);
  ASSERT_TRUE(fake.until([&] { return fake.driver().world().state(fake.task("law")) == State::kOff; }));
  EXPECT_TRUE(fake.until([&] { return fake.driver().world().logic.is_settled(); }));
  EXPECT_EQ(fake.driver().world().state(fake.task("law")), State::kOff);
}

TEST_F(SwitchCoordinatorTest, WithoutAnAnswerItIsAbortedBehindItsDeadline) {
  got.reset();
  coordinator().ask({kRest, SwitchCause::kScript, {}}, "operate", milliseconds(1), now(),
                    [this](const SwitchOutcome& outcome) { got = outcome; });
  ASSERT_TRUE(fake.until([&] { return agreement().plan().phase == SwitchPhase::kAborted; }));
  EXPECT_FALSE(got);
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kAborted);
}

}  // namespace
}  // namespace chimera::manager
