// SPDX-License-Identifier: Apache-2.0
// The manager's side of a switch; the test plays the rtpus.
#include "chimera/manager/switch/switch_coordinator.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstring>

#include "chimera/control/receipt/receipt_file.h"
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
  std::vector<std::string> filed() const { return control::ReceiptFile(fake.state() + "/chimera/fake").last(1000); }
  SwitchPart& part(std::uint32_t r) { return fake.rtpu(r).block().switch_part(); }
  /// The rtpu reports that it has finished its part.
  void over(std::uint32_t r, DecisionPage& page, NoSwitch why = NoSwitch::kNone) {
    part(r).number = PlanWord::of(page.switching.plan).number;
    part(r).why = why;
    fake.rtpu(r).block().head().switching.adopted = part(r).number;
    fake.rtpu(r).block().head().switching.over = part(r).number;
  }
  void over(std::uint32_t r, NoSwitch why = NoSwitch::kNone) { over(r, fake.decision_page(), why); }
  void commit_in(DecisionPage& page) {
    SwitchAgreement there(page.switching, fake.page().origin);
    const std::uint16_t number = there.plan().number;
    ASSERT_TRUE(there.propose(number, there.round_up(now() + milliseconds(1))));
    EXPECT_FALSE(there.agree(number, 0));
    ASSERT_TRUE(there.agree(number, 1));
  }
  void commit() { commit_in(fake.decision_page()); }
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

TEST_F(SwitchCoordinatorTest, OrdersARequestAndCombinesTheParts) {
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
  EXPECT_EQ(coordinator().under_way(), "switch 1 to 'rest', " + kByAnn);
  commit();
  part(0).tasks[0] = {fake.task("sensor"), TaskMove::kStays, Nanoseconds{-1}, Nanoseconds{-1}, 0};
  part(0).tasks[1] = {fake.task("filter"), TaskMove::kLeaves, Nanoseconds{-1}, microseconds(7), 2};
  part(0).n_tasks = 2;
  part(1).tasks[0] = {fake.task("law"), TaskMove::kLeaves, Nanoseconds{-1}, microseconds(8), 0};
  part(1).n_tasks = 1;
  over(0);
  EXPECT_TRUE(fake.step());
  EXPECT_FALSE(got) << "the other rtpu is not over";
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
  EXPECT_NE(fake.told("switch").find("switch 1 to 'rest', " + kByAnn + ": begun\n"), std::string::npos);
  EXPECT_NE(fake.told("switch").find("0 tasks arrive, 2 leave, 2 cycles lost\n"), std::string::npos);
}

TEST_F(SwitchCoordinatorTest, ASwitchToTheSetInForceDoesNothing) {
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
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().state(fake.task("law")) == State::kError; }));
  ask(kRun);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kRefused);
  EXPECT_EQ(got->receipt.why, NoSwitch::kInError);
  EXPECT_EQ(got->receipt.task, fake.task("law"));
  EXPECT_EQ(got->remedy, "`chimera clear law`");
  EXPECT_EQ(got->receipt.number, 2u);
  EXPECT_EQ(filed().size(), 2u);
}

TEST_F(SwitchCoordinatorTest, OneAtATimeAndItCanBeCancelled) {
  EXPECT_FALSE(coordinator().cancel(kBen, [](const SwitchOutcome&) {}));
  ask(kRest);
  std::optional<std::string> second, third;
  coordinator().ask({kRest, SwitchCause::kScript, {}}, kBen, seconds(1), now(), [&](const SwitchOutcome& outcome) {
    EXPECT_EQ(outcome.receipt.why, NoSwitch::kUnderWay);
    EXPECT_EQ(outcome.receipt.number, 2u);
    second = outcome.receipt.said.view();
  });
  ASSERT_TRUE(fake.until([&] { return second.has_value(); }));
  const std::string begin = "switch 1 to 'rest', " + kByAnn + ", is under way: arming, until ";
  EXPECT_EQ(second->substr(0, begin.size()), begin);
  EXPECT_EQ(second->size(), begin.size() + std::strlen("14:03:07"));
  EXPECT_TRUE(coordinator().cancel(kBen, [&](const SwitchOutcome& outcome) { third = outcome.json; }));
  EXPECT_FALSE(coordinator().cancel(kBen, [](const SwitchOutcome&) {}));
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kAborted);
  EXPECT_EQ(got->receipt.why, NoSwitch::kCancelled);
  EXPECT_EQ(got->receipt.said.view(), "configure:4000000002");
  EXPECT_EQ(third, got->json) << "the client that cancelled gets this receipt";
}

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

TEST_F(SwitchCoordinatorTest, ForeseesASwitchAndChangesNothing) {
  ForeseenSwitch foreseen = coordinator().foresee(tasks_of(fake.spec(), kRest));
  EXPECT_EQ(foreseen.receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(foreseen.receipt.before, kRun);
  EXPECT_EQ(foreseen.plan.leaving.size(), 2u);
  EXPECT_EQ(foreseen.plan.staying.size(), 1u);
  EXPECT_EQ(coordinator().foresee(tasks_of(fake.spec(), kRun)).receipt.end, SwitchEnd::kNothingToDo);
  EXPECT_EQ(agreement().plan().number, 0);
  EXPECT_FALSE(coordinator().is_under_way());
  ask(kRest);
  foreseen = coordinator().foresee(tasks_of(fake.spec(), kRun));
  EXPECT_EQ(foreseen.receipt.end, SwitchEnd::kRefused);
  EXPECT_EQ(foreseen.receipt.why, NoSwitch::kUnderWay);
  EXPECT_TRUE(foreseen.plan.leaving.empty());
  commit();
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.number, 1u) << "a foreseen switch has no number";
  EXPECT_EQ(filed().size(), 1u);
}

TEST_F(SwitchCoordinatorTest, TheRtpuThatAbortedSaysWhy) {
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

TEST_F(SwitchCoordinatorTest, ALateSwitchIsTriedFourTimes) {
  ask(kRest);
  Nanoseconds lead;
  for (std::uint16_t number = 1; number <= 4; ++number) {
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
  EXPECT_EQ(got->receipt.number, 1u) << "four plans, one switch";
  EXPECT_NE(got->json.find("\"tries\": 4, "), std::string::npos) << got->json;
  EXPECT_EQ(agreement().plan().number, 4);
}

TEST_F(SwitchCoordinatorTest, ASwitchWithoutAGapOrAReadyDeviceIsRepeatedSlowly) {
  const std::pair<NoSwitch, std::uint8_t> ways[] = {{NoSwitch::kNoGap, kSlowForGap},
                                                    {NoSwitch::kNotReady, kSlowForDevice}};
  std::uint16_t number = 1;
  for (const auto& [why, slow] : ways) {
    ask(kRest);
    for (const std::uint8_t expected : {std::uint8_t{0}, slow}) {
      ASSERT_TRUE(fake.until([&] { return agreement().plan().number == number && agreement().plan().is_open(); }));
      EXPECT_EQ(agreement().order(agreement().plan(), 2, 3)->slow, expected);
      EXPECT_FALSE(got);
      ASSERT_TRUE(agreement().abort(number++));
      over(0, why);
      over(1);
    }
    ASSERT_TRUE(until_answered());
    EXPECT_EQ(got->receipt.why, why) << "the slow way was not open either";
    EXPECT_EQ(got->receipt.way.slow, slow);
    EXPECT_EQ(got->receipt.tries, 2u);
  }
}

// The rtpus ring. A manager that polled from the deadline on without end would fill its CPU.
TEST_F(SwitchCoordinatorTest, NothingIsDueWhenThePlanIsNoMoreOpen) {
  EXPECT_EQ(coordinator().next_due(), kNever);
  ask(kRest);
  EXPECT_GE(coordinator().next_due(), now() + seconds(9));
  EXPECT_LE(coordinator().next_due(), now() + seconds(11));
  commit();
  EXPECT_EQ(coordinator().next_due(), kNever);
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
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

TEST_F(SwitchCoordinatorTest, ACancelledSwitchIsNotTriedAgain) {
  ask(kRest);
  EXPECT_TRUE(coordinator().cancel(kBen, [](const SwitchOutcome&) {}));
  over(0, NoSwitch::kLate);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.why, NoSwitch::kCancelled);
  EXPECT_EQ(agreement().plan().number, 1);
}

TEST_F(SwitchCoordinatorTest, ASuccessorGoesOnWithTheSwitchAndFilesItsReceipt) {
  ask(kRest);
  restart();
  EXPECT_EQ(coordinator().under_way(), "switch 1 to 'rest', " + kByAnn);
  EXPECT_TRUE(agreement().plan().is_open()) << "the rtpus need no manager";
  commit();
  over(0);
  over(1);
  ASSERT_TRUE(fake.until([&] { return filed().size() == 1; }));
  EXPECT_NE(filed()[0].find("\"number\": 1, "), std::string::npos);
  EXPECT_NE(filed()[0].find("\"end\": \"done\""), std::string::npos) << filed()[0];
  EXPECT_NE(filed()[0].find("\"user\": \"4000000001\""), std::string::npos) << filed()[0];
  EXPECT_FALSE(coordinator().is_under_way());
}

TEST_F(SwitchCoordinatorTest, TheNextManagerCollectsASwitchOfTheRtpus) {
  ask(kRest);
  fake.kill_manager();
  commit_in(fake.decision_page());
  over(0, fake.decision_page());
  over(1, fake.decision_page());
  fake.start_manager();
  ASSERT_TRUE(fake.until([&] { return filed().size() == 1; }));
  EXPECT_NE(filed()[0].find("\"end\": \"done\""), std::string::npos) << filed()[0];
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

// A switch that a task asked for, in the journal.
TEST_F(SwitchCoordinatorTest, ASuccessorKnowsTheTaskThatAsked) {
  const TaskId law = fake.task("law");
  coordinator().ask({kRest, SwitchCause::kMiss, law}, {}, seconds(10), now(), [](const SwitchOutcome&) {});
  EXPECT_EQ(coordinator().under_way(), "switch 1 to 'rest', asked for by on_miss of law");
  restart();
  EXPECT_EQ(coordinator().under_way(), "switch 1 to 'rest', asked for by on_miss of law");
  commit();
  over(0);
  over(1);
  ASSERT_TRUE(fake.until([&] { return filed().size() == 1; }));
  EXPECT_NE(filed()[0].find("{\"reaction\": \"on_miss\", \"task\": \"law\"}"), std::string::npos) << filed()[0];
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

// It would have turned law OFF: by its last words alone, law would come back.
TEST_F(SwitchCoordinatorTest, AnRtpuThatDiesBetweenCommitAndChangeComesBackToTheSetAfterIt) {
  ask(kRest);
  commit();
  fake.kill_rtpu(1, SIGKILL);
  over(0);
  fake.rtpu(0).block().set_status(fake.task("filter"), {State::kOff, false, 1});
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kDone);
  ASSERT_TRUE(fake.until([&] { return fake.loop().state().state(fake.task("law")) == State::kOff; }));
  EXPECT_TRUE(fake.until([&] { return fake.loop().state().logic.is_settled(); }));
  EXPECT_EQ(fake.loop().state().state(fake.task("law")), State::kOff);
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

TEST_F(SwitchCoordinatorTest, WithoutAnAnswerItIsAbortedBehindItsDeadline) {
  got.reset();
  coordinator().ask({kRest, SwitchCause::kScript, {}}, kAnn, milliseconds(1), now(),
                    [this](const SwitchOutcome& outcome) { take(outcome); });
  ASSERT_TRUE(fake.until([&] { return agreement().plan().phase == SwitchPhase::kAborted; }));
  EXPECT_FALSE(got);
  over(0);
  over(1);
  ASSERT_TRUE(until_answered());
  EXPECT_EQ(got->receipt.end, SwitchEnd::kAborted);
}

}  // namespace
}  // namespace chimera::manager
