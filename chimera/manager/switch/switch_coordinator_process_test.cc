// SPDX-License-Identifier: Apache-2.0
// The manager's side of a switch; the test plays the rtpus.
#include "chimera/manager/switch/switch_coordinator.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstring>

#include "chimera/control/rotated_file.h"
#include "chimera/control/receipt/switch_reason.h"
#include "chimera/manager/testing/fake_subsystem.h"

namespace chimera::manager {
namespace {

constexpr std::uint32_t kRun = 0, kRest = 1;
constexpr Asker kAnn{control::Role::kOperate, 4'000'000'001u}, kBen{control::Role::kConfigure, 4'000'000'002u};
const std::string kByAnn = "asked for by operate:4000000001";

struct SwitchCoordinatorTest : ::testing::Test {
  SwitchCoordinatorTest() {
    fake.start_manager();
    EXPECT_TRUE(is_settled());
  }
  bool is_settled() {
    return fake.until_on("law") && fake.until([this] { return fake.loop().state().logic.is_settled(); });
  }
  SwitchCoordinator& coordinator() { return fake.loop().switches(); }
  SwitchAgreement agreement() { return {fake.loop().state().page.switching, fake.loop().state().keeper.origin}; }
  void ask(std::uint32_t set) {
    got.reset();
    coordinator().ask({set, SwitchCause::kScript, {}}, kAnn, seconds(10), now(),
                      [this](const SwitchOutcome& outcome) { take(outcome); });
  }
  void take(const SwitchOutcome& outcome) {
    got = outcome;
    got->receipt.tasks = got->tasks;
    got->receipt.variables = got->variables;
  }
  /// The receipts in the file.
  std::vector<std::string> filed() const {
    return control::RotatedFile(fake.state() + "/chimera/fake", "receipts").last(1000);
  }
  SwitchPart& part(std::uint32_t r) { return fake.rtpu(r).block().switch_part(); }
  /// The rtpu reports that it has finished its part.
  void over(std::uint32_t r, NoSwitch why = NoSwitch::kNone) {
    part(r).number = agreement().plan().number;
    part(r).why = why;
    fake.rtpu(r).block().head().switching.adopted = part(r).number;
    fake.rtpu(r).block().head().switching.over = part(r).number;
  }
  void commit() {
    SwitchAgreement there = agreement();
    const std::uint16_t number = there.plan().number;
    ASSERT_TRUE(there.propose(number, there.round_up(now() + milliseconds(1))));
    EXPECT_FALSE(there.agree(number, 0));
    ASSERT_TRUE(there.agree(number, 1));
  }
  /// Replaces the manager as if it had been killed.
  void restart() {
    fake.kill_manager();
    fake.start_manager();
    ASSERT_TRUE(is_settled());
  }
  bool until_answered() {
    return fake.until([this] { return got.has_value(); });
  }

  FakeSubsystem fake;
  std::optional<SwitchOutcome> got;
};

TEST_F(SwitchCoordinatorTest, ACommittedSwitchIsNotCancelled) {
  ask(kRest);
  commit();
  EXPECT_FALSE(coordinator().cancel(kBen, [](const SwitchOutcome&) {}));
  EXPECT_EQ(coordinator().progress(), "committed");
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kDone);
}

// The rtpus ring. A manager that polled from the deadline on without end would fill its CPU.
TEST_F(SwitchCoordinatorTest, OnlyTheEndOfRtpusThatHoldItUpIsDueWhenThePlanIsNoMoreOpen) {
  EXPECT_EQ(coordinator().next_due(), kNever);
  ask(kRest);
  EXPECT_GE(coordinator().next_due(), now() + seconds(9));
  EXPECT_LE(coordinator().next_due(), now() + seconds(11));
  commit();
  EXPECT_GE(coordinator().next_due(), now() + seconds(19));
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(coordinator().next_due(), kNever);
}

TEST_F(SwitchCoordinatorTest, AFailureCountsMoreThanLatenessOrNoAnswer) {
  std::uint16_t number = 0;
  for (const auto& [first, second] : {std::pair{NoSwitch::kLate, NoSwitch::kOnFailed},
                                      {NoSwitch::kNoAnswer, NoSwitch::kNotSafe},
                                      {NoSwitch::kNoAnswer, NoSwitch::kNone}}) {
    ask(kRest);
    ASSERT_TRUE(agreement().abort(++number));
    over(0, first);
    over(1, second);
    ASSERT_TRUE(until_answered());
    EXPECT_EQ(got->receipt.why, second == NoSwitch::kNone ? first : second);
    EXPECT_EQ(got->receipt.tries, 1u) << "nor is it a reason to go slowly";
  }
}

TEST_F(SwitchCoordinatorTest, ASwitchThatTheEndOfTheRunDisturbsSaysSo) {
  ask(kRest);
  fake.page().ending = 1;
  over(0, NoSwitch::kDisturbed);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.why, NoSwitch::kRunEnded);
  EXPECT_FALSE(got->receipt.task.is_valid());
}

TEST_F(SwitchCoordinatorTest, ACancelledSwitchIsNotTriedAgain) {
  ask(kRest);
  EXPECT_TRUE(coordinator().cancel(kBen, [](const SwitchOutcome&) {}));
  over(0, NoSwitch::kLate);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.why, NoSwitch::kCancelled);
  EXPECT_EQ(agreement().plan().number, 1);
}

TEST_F(SwitchCoordinatorTest, ASuccessorClosesAPlanThatIsPastItsDeadline) {
  coordinator().ask({kRest, SwitchCause::kScript, {}}, kAnn, milliseconds(1), now(), [](const SwitchOutcome&) {});
  restart();
  ask(kRest);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.why, NoSwitch::kUnderWay);
  EXPECT_TRUE(got->receipt.said.view().starts_with("switch 1 to 'rest', " + kByAnn + ", is under way: "));
  ASSERT_TRUE(fake.until([&] { return agreement().plan().phase == SwitchPhase::kAborted; }));
  over(0);
  over(1);
  ASSERT_TRUE(fake.until([&] { return filed().size() == 2; }));
  ask(kRest);
  EXPECT_FALSE(got);
  EXPECT_EQ(agreement().plan().number, 2);
}

// The manager was killed between the journal and the plan. The switch was not announced, so the next one gets its
// number.
TEST_F(SwitchCoordinatorTest, ForgetsASwitchThatWasNeverAnnounced) {
  BegunSwitch begun;
  begun.order.number = 1;
  begun.order.after = kRest;
  SwitchJournal(fake.loop().state().own.block().journal()).begin(begun);
  restart();
  EXPECT_FALSE(coordinator().is_under_way());
  ask(kRest);
  EXPECT_FALSE(got) << got->json;
  EXPECT_EQ(coordinator().under_way(), "switch 1 to 'rest', " + kByAnn);
}

// The manager was killed between the journal and the plan of another try. The successor reports that the first try was
// late, or tries again.
TEST_F(SwitchCoordinatorTest, ATryThatWasNotAnnouncedIsMadeAgain) {
  ask(kRest);
  SwitchJournal journal(fake.loop().state().own.block().journal());
  BegunSwitch second = *journal.begun();
  second.tries = 2;
  second.order.number = 2;
  journal.change(second);
  ASSERT_TRUE(agreement().abort(1));
  over(0, NoSwitch::kLate);
  over(1);
  restart();
  ASSERT_TRUE(fake.until([&] { return agreement().plan().number == 2; }));
  commit();
  over(0);
  over(1);
  ASSERT_TRUE(fake.until([&] { return filed().size() == 1; }));
  EXPECT_NE(filed()[0].find("\"tries\": 2, "), std::string::npos) << filed()[0];
}

TEST_F(SwitchCoordinatorTest, ACauseOrATaskThatCannotBeIsForgotten) {
  const auto change = [&](SwitchCause cause, TaskId by) {
    coordinator().ask({kRest, SwitchCause::kMiss, fake.task("law")}, {}, seconds(10), now(),
                      [](const SwitchOutcome&) {});
    SwitchJournal journal(fake.loop().state().own.block().journal());
    BegunSwitch damaged = *journal.begun();
    damaged.cause = cause;
    damaged.by = by;
    journal.change(damaged);
    restart();
    EXPECT_FALSE(coordinator().is_under_way());
    ASSERT_TRUE(fake.until([&] { return agreement().plan().phase == SwitchPhase::kAborted; }));
    over(0);
    over(1);
  };
  change(SwitchCause::kMiss, TaskId{});
  change(SwitchCause::kFault, TaskId(99u));
  change(SwitchCause::kScript, TaskId(99u));
  change(static_cast<SwitchCause>(9), fake.task("law"));
}

// The page has its number, but the journal has no entry: no manager wrote it.
TEST_F(SwitchCoordinatorTest, APlanWithoutAJournalEntryIsAborted) {
  SwitchOrder order;
  order.number = 7;
  order.members = 0b11;
  order.until = now() + seconds(100);
  agreement().announce(order);
  EXPECT_TRUE(fake.until([&] { return agreement().plan().phase == SwitchPhase::kAborted; }));
  ask(kRest);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.said.view(), "the rtpus are not done with the last switch");
}

// The memory of an rtpu may hold any value.
TEST_F(SwitchCoordinatorTest, APartThatDoesNotFitTheApplicationIsLeftOut) {
  ask(kRest);
  commit();
  std::memset(static_cast<void*>(part(0).tasks.data()), 0xff, sizeof part(0).tasks);
  std::memset(static_cast<void*>(part(0).variables.data()), 0xff, sizeof part(0).variables);
  std::memset(part(0).said, 'x', sizeof part(0).said);
  part(0).n_tasks = part(0).n_variables = UINT32_MAX;
  part(0).task = TaskId(77u);
  // A task of the other rtpu.
  part(1).tasks[0] = {fake.task("sensor"), TaskMove::kStays, Nanoseconds{-1}, Nanoseconds{-1}, 0};
  part(1).n_tasks = 1;
  over(0, NoSwitch::kOnFailed);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kDone);
  EXPECT_TRUE(got->tasks.empty());
  EXPECT_TRUE(got->variables.empty());
}

// One rtpu has agreed and died; the other would agree next. The tasks that come back are decided now, so the plan must
// be decided too.
TEST_F(SwitchCoordinatorTest, ADeathClosesThePlanBeforeTheGoalsOfTheRtpuAreDecided) {
  ask(kRest);
  const std::uint16_t number = agreement().plan().number;
  ASSERT_TRUE(agreement().propose(number, agreement().round_up(now() + milliseconds(1))));
  EXPECT_FALSE(agreement().agree(number, 1));
  fake.kill_rtpu(1, SIGKILL);
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().state(fake.task("law")) != State::kOn; }));
  EXPECT_FALSE(agreement().agree(number, 0)) << "otherwise law comes back although it is not in the set";
  EXPECT_EQ(agreement().plan().phase, SwitchPhase::kAborted);
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kAborted);
  EXPECT_EQ(got->receipt.why, NoSwitch::kMemberDied);
  EXPECT_TRUE(fake.until_on("law"));
}

/// Requests of tasks; the test plays the rtpus.
struct SwitchWishesTest : SwitchCoordinatorTest {
  PlanWord plan() { return agreement().plan(); }
  void wish(std::uint32_t rtpu, std::uint32_t set, const char* task) {
    SwitchWishWords& words = fake.rtpu(rtpu).block().head().wish;
    words.write(words.wish().next({set, SwitchCause::kRequest, fake.task(task)}), {}, now());
  }
  void rounds(int n = 5) {
    for (int i = 0; i < n; ++i) ASSERT_TRUE(fake.step());
  }
};

TEST_F(SwitchWishesTest, TheLastOfAllStands) {
  wish(1, kRest, "law");
  wish(0, kRun, "sensor");
  rounds();
  EXPECT_EQ(plan().number, 0);
}

TEST_F(SwitchWishesTest, ReportsARefusedRequestOnce) {
  fake.rtpu(1).fail(fake.task("law"), "as told");
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().state(fake.task("law")) == State::kError; }));
  wish(0, kRun, "sensor");
  ASSERT_TRUE(fake.until([this] { return filed().size() == 1 && !fake.told("switch").empty(); }));
  rounds(20);
  ASSERT_EQ(filed().size(), 1u);
  EXPECT_NE(filed()[0].find("\"asked_by\": {\"task\": \"sensor\"}, \"end\": \"refused\""), std::string::npos)
      << filed()[0];
  EXPECT_EQ(fake.told("switch"),
            "switch to 'run', asked for by task sensor, is refused: task 'law' is in ERROR: clear it first\n");
}

TEST_F(SwitchWishesTest, ARequestOutlivesItsRtpu) {
  wish(1, kRest, "law");
  fake.kill_rtpu(1, SIGKILL);
  EXPECT_TRUE(fake.until([this] { return plan().number == 1; }));
  EXPECT_TRUE(coordinator().leads_to({kRest, SwitchCause::kRequest, {}}));
}

// The memory of an rtpu may hold any value.
TEST_F(SwitchWishesTest, SkipsRequestsThatDoNotFitTheApplication) {
  SwitchWishWords& words = fake.rtpu(1).block().head().wish;
  const auto law = static_cast<std::uint16_t>(fake.task("law").index);
  const auto sensor = static_cast<std::uint16_t>(fake.task("sensor").index);
  const SwitchWish lists{1, SwitchWish::kLists, law, SwitchCause::kRequest};
  TaskLists beyond;
  beyond.minus.add(TaskId(std::size_t{255}));
  const std::pair<SwitchWish, TaskLists> nonsense[] = {{SwitchWish::of(~std::uint64_t{0}), {}},
                                                       {{1, 2, law, SwitchCause::kRequest}, {}},
                                                       {{1, kRest, 99, SwitchCause::kRequest}, {}},
                                                       {{1, kRest, sensor, SwitchCause::kMiss}, {}},
                                                       {{1, kRest, law, SwitchCause::kScript}, {}},
                                                       {{0, kRest, law, SwitchCause::kMiss}, {}},
                                                       {lists, {}},
                                                       {lists, beyond}};
  for (const auto& [wish, named] : nonsense) {
    words.write(wish, named, now());
    rounds(2);
    EXPECT_EQ(plan().number, 0) << std::hex << wish.word();
  }
}

}  // namespace
}  // namespace chimera::manager
