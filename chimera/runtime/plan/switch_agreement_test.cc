// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/switch_agreement.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>
#include <thread>
#include <vector>

namespace chimera::switch_agreement_test {
namespace {

constexpr Nanoseconds kOrigin = seconds(5);

SwitchOrder some_order(std::uint16_t number = 7, std::uint16_t members = 0b11) {
  SwitchOrder order;
  order.number = number;
  order.members = members;
  order.after = 1;
  order.until = kOrigin + seconds(10);
  order.lead = microseconds(300);
  order.on.add(TaskId(0u));
  order.on.add(TaskId(66u));
  order.target.add(TaskId(65u));
  return order;
}

struct SwitchAgreementTest : ::testing::Test {
  SwitchPage page;
  SwitchAgreement agreement{page, kOrigin};
};

TEST_F(SwitchAgreementTest, APageOfZerosHasNoOpenPlanAndNoOrder) {
  EXPECT_FALSE(agreement.plan().is_open());
  EXPECT_EQ(agreement.plan().number, 0);
  EXPECT_FALSE(agreement.order(agreement.plan(), 2, 70));
  EXPECT_FALSE(agreement.abort(0));
}

TEST_F(SwitchAgreementTest, TheOrderArrivesAsItWasWritten) {
  agreement.announce(some_order());
  const PlanWord plan = agreement.plan();
  EXPECT_EQ(plan.number, 7);
  EXPECT_EQ(plan.phase, SwitchPhase::kPrepared);
  ASSERT_TRUE(agreement.order(plan, 2, 70));
  EXPECT_EQ(*agreement.order(plan, 2, 70), some_order());
  EXPECT_EQ(agreement.run(7), 0);
  EXPECT_FALSE(agreement.run(8));
}

TEST_F(SwitchAgreementTest, RefusesAnOrderThatDoesNotFitTheApplication) {
  agreement.announce(some_order());
  EXPECT_FALSE(agreement.order(agreement.plan(), 1, 70)) << "there is no set 1";
  EXPECT_FALSE(agreement.order(agreement.plan(), 2, 66)) << "there is no task 66";
  EXPECT_FALSE(agreement.order({8, SwitchPhase::kPrepared, 0}, 2, 70)) << "it is of plan 7";
  SwitchOrder other = some_order();
  other.after = UINT32_MAX;
  agreement.announce(other);
  ASSERT_TRUE(agreement.order(agreement.plan(), 2, 70)) << "a set without a name";
  other.target.add(TaskId(70u));
  agreement.announce(other);
  EXPECT_FALSE(agreement.order(agreement.plan(), 2, 70)) << "there is no task 70";
  agreement.announce(some_order(9, 0));
  EXPECT_FALSE(agreement.order(agreement.plan(), 2, 70)) << "the order has no members";
}

TEST_F(SwitchAgreementTest, RefusesAnOrderWhoseTimesOverflow) {
  for (const std::int64_t far : {INT64_MAX, INT64_MAX / 2, INT64_MIN, std::int64_t{-1}}) {
    SwitchOrder late = some_order(), early = some_order();
    late.until = {far};
    early.lead = {far};
    agreement.announce(late);
    EXPECT_FALSE(agreement.order(agreement.plan(), 2, 70)) << far;
    agreement.announce(early);
    EXPECT_FALSE(agreement.order(agreement.plan(), 2, 70)) << far;
  }
}

TEST_F(SwitchAgreementTest, AStrayWriteIsFound) {
  agreement.announce(some_order());
  for (auto& word : page.order)
    for (int bit = 0; bit < 64; ++bit) {
      word.fetch_xor(std::uint64_t{1} << bit);
      EXPECT_FALSE(agreement.order(agreement.plan(), 2, 70));
      word.fetch_xor(std::uint64_t{1} << bit);
    }
  EXPECT_TRUE(agreement.order(agreement.plan(), 2, 70));
}

TEST_F(SwitchAgreementTest, TheLastToAgreeCommits) {
  agreement.announce(some_order());
  EXPECT_TRUE(agreement.hand_on(7, 0));
  EXPECT_EQ(agreement.run(7), 1);
  EXPECT_FALSE(agreement.hand_on(7, 0)) << "run 0 is over";
  const Nanoseconds at = kOrigin + microseconds(1234);
  EXPECT_TRUE(agreement.propose(7, at));
  EXPECT_FALSE(agreement.propose(7, at + microseconds(1)));
  EXPECT_EQ(agreement.at(agreement.plan()), at);
  EXPECT_FALSE(agreement.agree(7, 1));
  EXPECT_FALSE(agreement.agree(7, 1)) << "once or twice";
  EXPECT_EQ(agreement.plan().phase, SwitchPhase::kProposed);
  EXPECT_TRUE(agreement.agree(7, 0));
  EXPECT_EQ(agreement.plan().phase, SwitchPhase::kCommitted);
  EXPECT_EQ(agreement.at(agreement.plan()), at);
  EXPECT_FALSE(agreement.abort(7)) << "never after the commit";
}

TEST_F(SwitchAgreementTest, AnAbortEndsItBeforeTheCommit) {
  for (const bool is_proposed : {false, true}) {
    agreement.announce(some_order(is_proposed ? 2 : 1));
    const std::uint16_t number = agreement.plan().number;
    if (is_proposed) {
      EXPECT_TRUE(agreement.propose(number, kOrigin));
    }
    EXPECT_TRUE(agreement.abort(number));
    EXPECT_EQ(agreement.plan().phase, SwitchPhase::kAborted);
    EXPECT_FALSE(agreement.propose(number, kOrigin));
    EXPECT_FALSE(agreement.agree(number, 0));
    EXPECT_FALSE(agreement.agree(number, 1));
    EXPECT_EQ(agreement.plan().phase, SwitchPhase::kAborted);
  }
}

// A context was delayed since the plan before.
TEST_F(SwitchAgreementTest, AContextWithAnOlderPlanChangesNothing) {
  agreement.announce(some_order(3));
  EXPECT_TRUE(agreement.abort(3));
  agreement.announce(some_order(4));
  const std::uint64_t plan = page.plan, turn = page.turn;
  EXPECT_FALSE(agreement.hand_on(3, 0));
  EXPECT_FALSE(agreement.propose(3, kOrigin));
  EXPECT_FALSE(agreement.agree(3, 0));
  EXPECT_FALSE(agreement.abort(3));
  EXPECT_EQ(page.plan, plan);
  EXPECT_EQ(page.turn, turn);
}

TEST_F(SwitchAgreementTest, ASlowPlanCountsItsStepsForwardsAndBackAndCommitsAtOnce) {
  SwitchOrder order = some_order();
  order.slow = kSlowForConstants;
  order.constants = 0;
  agreement.announce(order);
  EXPECT_EQ(*agreement.order(agreement.plan(), 2, 70), order);
  EXPECT_TRUE(agreement.move_turn(7, 0, 1));
  EXPECT_FALSE(agreement.move_turn(7, 0, 1)) << "another one did";
  EXPECT_TRUE(agreement.move_turn(7, 1, TurnWord::kBack | 1));
  EXPECT_FALSE(agreement.move_turn(6, TurnWord::kBack | 1, 0)) << "it is of plan 7";
  EXPECT_EQ(agreement.run(7), TurnWord::kBack | 1);
  EXPECT_FALSE(agreement.agree(7, 0) || agreement.have_all_agreed(7));
  EXPECT_FALSE(agreement.agree(7, 1));
  EXPECT_TRUE(agreement.have_all_agreed(7));
  EXPECT_EQ(agreement.plan().phase, SwitchPhase::kPrepared);
  EXPECT_TRUE(agreement.commit(7, kOrigin + microseconds(9)));
  EXPECT_EQ(agreement.plan().phase, SwitchPhase::kCommitted);
  EXPECT_EQ(agreement.at(agreement.plan()), kOrigin + microseconds(9));
  EXPECT_FALSE(agreement.abort(7));
  order.constants = 2;
  order.number = 8;
  agreement.announce(order);
  EXPECT_FALSE(agreement.order(agreement.plan(), 2, 70)) << "there is no set 2";
  EXPECT_TRUE(agreement.abort(8));
  EXPECT_FALSE(agreement.commit(8, kOrigin));
}

TEST_F(SwitchAgreementTest, OverwrittenWordsAreWrittenAnewAsAborted) {
  const SwitchOrder order = some_order();
  for (const std::uint64_t word : {std::uint64_t{0}, ~std::uint64_t{0}, std::uint64_t{0x5a5a'5a5a'5a5a'5a5a}}) {
    for (std::atomic<std::uint64_t>* one : {&page.plan, &page.turn}) {
      agreement.announce(order);
      EXPECT_FALSE(agreement.is_overwritten(7));
      one->store(word);
      page.order[2].store(word);
      EXPECT_TRUE(agreement.is_overwritten(7));
      agreement.restore(order, {7, SwitchPhase::kAborted, 0}, TurnWord::kBack | 3);
      EXPECT_FALSE(agreement.is_overwritten(7));
      EXPECT_EQ(agreement.plan().phase, SwitchPhase::kAborted);
      EXPECT_EQ(agreement.run(7), TurnWord::kBack | 3);
      EXPECT_EQ(*agreement.order(agreement.plan(), 2, 70), order);
    }
  }
  agreement.announce(order);
  EXPECT_TRUE(agreement.commit(7, kOrigin));
  page.turn.store(0);
  EXPECT_FALSE(agreement.is_overwritten(7)) << "a plan that is committed needs no turn";
}

// Fault row 27, the stale plan after a restart: any acts of earlier plans come between any two steps of the present
// plan, which is still committed or aborted.
TEST_F(SwitchAgreementTest, AHundredThousandActsOfOlderPlansChangeNothing) {
  std::mt19937 random(27);
  int replays = 0;
  std::uint16_t number = 60'000;  // so that the numbers begin again on the way
  const auto replay = [&] {
    const std::uint64_t plan = page.plan, turn = page.turn;
    for (int i = 0; i < 20; ++i, ++replays) {
      std::uint16_t old = number;
      for (auto back = random() % 50 + 1; back > 0; --back)
        old = old == 1 ? UINT16_MAX : static_cast<std::uint16_t>(old - 1);
      switch (random() % 4) {
        case 0: EXPECT_FALSE(agreement.hand_on(old, static_cast<std::uint16_t>(random() % 2))); break;
        case 1: EXPECT_FALSE(agreement.propose(old, kOrigin + microseconds(1))); break;
        case 2: EXPECT_FALSE(agreement.agree(old, static_cast<std::uint32_t>(random() % 2))); break;
        default: EXPECT_FALSE(agreement.abort(old));
      }
    }
    EXPECT_EQ(page.plan, plan);
    EXPECT_EQ(page.turn, turn);
  };
  while (replays < 100'000) {
    number = next_plan(number);
    agreement.announce(some_order(number));
    replay();
    EXPECT_TRUE(agreement.hand_on(number, 0));
    replay();
    EXPECT_TRUE(agreement.propose(number, kOrigin + microseconds(5)));
    replay();
    const bool is_aborted = random() % 4 == 0;
    EXPECT_FALSE(agreement.agree(number, 0));
    replay();
    EXPECT_TRUE(is_aborted ? agreement.abort(number) : agreement.agree(number, 1));
    replay();
    EXPECT_EQ(agreement.plan().phase, is_aborted ? SwitchPhase::kAborted : SwitchPhase::kCommitted);
  }
}

TEST_F(SwitchAgreementTest, InstantsAreWholeMicrosecondsOfTheGrid) {
  EXPECT_EQ(agreement.round_up(kOrigin + microseconds(3)), kOrigin + microseconds(3));
  EXPECT_EQ(agreement.round_up(kOrigin + Nanoseconds{3001}), kOrigin + microseconds(4));
  EXPECT_EQ(agreement.round_up(Nanoseconds{}), kOrigin);
  EXPECT_EQ(agreement.round_up(kOrigin + seconds(70'000'000)), kOrigin + seconds(70'000'000));
  EXPECT_EQ(agreement.round_up(kOrigin + seconds(71'000'000)), kNever);
}

TEST_F(SwitchAgreementTest, NumbersGoRoundWithoutZero) {
  EXPECT_EQ(next_plan(0), 1);
  EXPECT_EQ(next_plan(UINT16_MAX), 1);
}

// Members agree, one or two of them abort, all at the same time: the outcome is one, and the same for all.
TEST_F(SwitchAgreementTest, ThreadsComeToOneOutcome) {
  constexpr std::uint32_t kThreads = 4;
  std::mt19937 random(11);
  int committed = 0, aborted = 0;
  for (std::uint16_t number = 1; number <= 400; ++number) {
    agreement.announce(some_order(number, (1u << kThreads) - 1));
    ASSERT_TRUE(agreement.propose(number, kOrigin + microseconds(number)));
    const std::uint32_t aborter = random() % (2 * kThreads);  // none in half of the rounds
    std::atomic<std::uint32_t> ready{0};
    bool did_commit[kThreads] = {}, did_abort = false;
    std::vector<std::thread> threads;
    for (std::uint32_t me = 0; me < kThreads; ++me)
      threads.emplace_back([&, me] {
        ++ready;
        while (ready < kThreads) std::this_thread::yield();
        did_commit[me] = agreement.agree(number, me);
        if (me == aborter) did_abort = agreement.abort(number);
      });
    for (std::thread& thread : threads) thread.join();
    const int n = did_commit[0] + did_commit[1] + did_commit[2] + did_commit[3];
    const PlanWord plan = agreement.plan();
    ASSERT_EQ(plan.number, number);
    ASSERT_EQ(n, plan.phase == SwitchPhase::kCommitted ? 1 : 0);
    ASSERT_EQ(did_abort, plan.phase == SwitchPhase::kAborted);
    if (n == 1) {
      ASSERT_EQ(plan.at_us, number);
    }
    ++(n == 1 ? committed : aborted);
  }
  EXPECT_GT(committed, 150);
  EXPECT_GT(committed + aborted, 399);
}

}  // namespace
}  // namespace chimera::switch_agreement_test
