// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/standbys.h"

#include <gtest/gtest.h>

#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera::standbys_test {
namespace {

constexpr TaskId kPrimary{0u}, kOther{1u}, kFirst{2u}, kSecond{3u};

/// A primary at 1 kHz with two standbys, named in the order kSecond, kFirst of the description, and a task without.
class StandbysTest : public ::testing::Test {
 protected:
  StandbysTest() {
    for (TaskSpec& task : tasks_) task.period = milliseconds(1);
    tasks_[kSecond.index].period = milliseconds(4);
    spec_.tasks = tasks_;
    spec_.standbys = pairs_;
    rivals_.prepare(spec_, memory_);
    standbys_.prepare(spec_, rivals_, memory_);
  }
  void at(std::int64_t ms) {
    now_ = milliseconds(ms);
    standbys_.follow(states_, living_, now_);
  }
  void set(TaskId task, State state) { states_[task.index] = state; }
  void fail(TaskId task, std::int64_t ms) {
    set(task, State::kError);
    at(ms);
  }
  /// next(0) goes ON.
  TaskId take_over(std::int64_t ms) {
    const TaskId next = standbys_.next(0);
    if (next.is_valid()) set(next, State::kOn);
    at(ms);
    return next;
  }

  TaskSpec tasks_[4];
  StandbySpec pairs_[2] = {{kPrimary, kSecond}, {kPrimary, kFirst}};
  ApplicationSpec spec_;
  HeapMemory memory_;
  Rivals rivals_;
  Standbys standbys_;
  std::uint32_t living_ = 1;
  std::vector<State> states_{State::kOn, State::kOn, State::kOff, State::kOff};
  Nanoseconds now_;
};

TEST_F(StandbysTest, NoTakeoverWhenThePrimaryIsOnOrTurnedOff) {
  at(1);
  EXPECT_EQ(standbys_.n_groups(), 1u);
  EXPECT_FALSE(standbys_.next(0).is_valid());
  set(kPrimary, State::kOff);
  at(2);
  EXPECT_FALSE(standbys_.next(0).is_valid());
  EXPECT_FALSE(standbys_.is_any_uncovered() || standbys_.is_any_waiting());
  fail(kPrimary, 3);  // in a signal: it was not ON
  EXPECT_FALSE(standbys_.next(0).is_valid());
  EXPECT_FALSE(standbys_.is_any_uncovered());
  EXPECT_EQ(standbys_.due(), kNever);
}

TEST_F(StandbysTest, TheFirstOfTheDescriptionTakesOverAndCoversForOnePeriodOfIts) {
  at(1);
  fail(kPrimary, 2);
  EXPECT_EQ(standbys_.next(0), kSecond);
  EXPECT_EQ(standbys_.loss(0).task, kPrimary);
  EXPECT_TRUE(standbys_.is_covered(kPrimary));
  EXPECT_TRUE(standbys_.is_awaited(kPrimary));
  EXPECT_FALSE(standbys_.is_covered(kOther));
  EXPECT_EQ(standbys_.due(), milliseconds(6));
  at(5);
  EXPECT_TRUE(standbys_.is_covered(kPrimary));
  at(6);
  EXPECT_FALSE(standbys_.is_covered(kPrimary));
  EXPECT_TRUE(standbys_.is_any_uncovered());
  EXPECT_EQ(standbys_.due(), kNever);
  EXPECT_EQ(take_over(7), kSecond) << "late is better than never";
  EXPECT_FALSE(standbys_.is_any_uncovered());
  EXPECT_TRUE(standbys_.is_replaced(kPrimary));
  EXPECT_FALSE(standbys_.is_replaced(kSecond));
}

TEST_F(StandbysTest, SkipsAStandbyWhoseOnFailed) {
  at(1);
  fail(kPrimary, 2);
  standbys_.rule_out(kSecond);  // its on failed, and it is OFF again
  at(2);
  EXPECT_EQ(standbys_.next(0), kFirst);
  set(kFirst, State::kError);
  at(2);
  EXPECT_FALSE(standbys_.next(0).is_valid());
  EXPECT_TRUE(standbys_.is_any_uncovered()) << "no standby is left: uncovered now, not after a period";
  set(kPrimary, State::kOff);
  at(3);
  EXPECT_FALSE(standbys_.is_any_uncovered()) << "cleared";
}

TEST_F(StandbysTest, ThePrimaryThatWasClearedIsTheFirstToTakeOverFromItsStandby) {
  at(1);
  fail(kPrimary, 2);
  EXPECT_EQ(take_over(2), kSecond);
  set(kPrimary, State::kOff);
  at(3);
  EXPECT_FALSE(standbys_.next(0).is_valid()) << "it stays OFF";
  fail(kSecond, 4);
  EXPECT_EQ(take_over(4), kPrimary);
}

TEST_F(StandbysTest, TheFourthFailureInTenSecondsIsNotAnswered) {
  at(1);
  for (int i = 0; i < 3; ++i) {
    const bool is_primary = i % 2 == 0;
    fail(is_primary ? kPrimary : kSecond, 1000 * i + 100);
    EXPECT_EQ(take_over(1000 * i + 100), is_primary ? kSecond : kPrimary) << i;
    set(is_primary ? kPrimary : kSecond, State::kOff);
    at(1000 * i + 200);
  }
  fail(kSecond, 10'099);
  EXPECT_FALSE(standbys_.next(0).is_valid());
  EXPECT_TRUE(standbys_.is_any_uncovered());
  EXPECT_FALSE(standbys_.is_covered(kSecond));
  set(kSecond, State::kOn);  // by a person
  at(10'100);
  fail(kSecond, 10'100);
  EXPECT_EQ(standbys_.next(0), kPrimary) << "the first takeover is ten seconds ago";
}

TEST_F(StandbysTest, ASwitchToASetWithoutTheGroupEndsIt) {
  at(1);
  fail(kPrimary, 2);
  TaskBits target;
  target.add(kFirst);
  standbys_.follow_switch(target);
  EXPECT_EQ(standbys_.next(0), kSecond);
  standbys_.follow_switch({});
  at(2);
  EXPECT_FALSE(standbys_.next(0).is_valid());
  EXPECT_FALSE(standbys_.is_any_uncovered() || standbys_.is_covered(kPrimary));
}

TEST_F(StandbysTest, CoveredTasksCountBesideAllButTheirOwnGroup) {
  at(1);
  fail(kPrimary, 2);
  bool on[4] = {};
  const TaskId first[] = {kFirst}, other[] = {kOther};
  standbys_.add_covered(on, first);
  EXPECT_FALSE(on[kPrimary.index]);
  standbys_.add_covered(on, other);
  EXPECT_TRUE(on[kPrimary.index]);
}

}  // namespace
}  // namespace chimera::standbys_test
