// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/blame.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

namespace chimera {
namespace {

constexpr TaskId kFirst{0u}, kSecond{1u}, kThird{2u};

/// Jobs that are under way, by task.
class UnderWay final : public JobThreads {
 public:
  bool claim(TaskId) noexcept override { return true; }
  Nanoseconds used_by_job(TaskId task) noexcept override {
    const auto found = used.find(task.index);
    return found == used.end() ? Nanoseconds{} : found->second;
  }
  bool is_blocked(TaskId task) noexcept override { return task == blocked; }
  std::map<std::uint32_t, Nanoseconds> used;
  TaskId blocked;
};

/// Three tasks of 10 ms: the first and the second with a budget of 2 ms, the third with none.
class BlameTest : public testing::Test {
 protected:
  BlameTest() {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      specs[i].period = specs[i].deadline = milliseconds(10);
      specs[i].budget = i < 2 ? milliseconds(2) : Nanoseconds{};
      tasks[i].id = TaskId(i);
      tasks[i].spec = &specs[i];
    }
  }
  Blame::Verdict judged(TaskId missed, std::int64_t now_ms) {
    const auto verdict = blame.judge(missed, milliseconds(now_ms));
    EXPECT_TRUE(verdict);
    return verdict ? *verdict : Blame::Verdict{};
  }

  std::array<TaskSpec, 3> specs;
  std::array<Task, 3> tasks;
  UnderWay under_way;
  Blame blame{tasks, &under_way};
};

TEST_F(BlameTest, FindsWhoWentFurthestBeyondItsBudget) {
  blame.ended(kFirst, milliseconds(3), milliseconds(13));
  blame.ended(kSecond, milliseconds(6), milliseconds(19));
  blame.missed(kFirst, milliseconds(10));
  const Blame::Verdict verdict = judged(kFirst, 21);
  EXPECT_EQ(verdict.culprit, kSecond);
  EXPECT_EQ(verdict.used, milliseconds(6));
}

TEST_F(BlameTest, MeasuresATaskWithoutABudgetByItsPeriod) {
  blame.ended(kThird, milliseconds(9), milliseconds(15));
  blame.ended(kFirst, microseconds(2100), milliseconds(18));
  blame.missed(kSecond, milliseconds(10));
  EXPECT_EQ(judged(kSecond, 21).culprit, kFirst) << "9 ms of 10 are within, 2.1 of 2 are not";
}

TEST_F(BlameTest, CountsAJobThatIsUnderWay) {
  under_way.used[kThird.index] = milliseconds(11);
  blame.ended(kFirst, milliseconds(3), milliseconds(13));
  blame.missed(kFirst, milliseconds(10));
  const Blame::Verdict verdict = judged(kFirst, 21);
  EXPECT_EQ(verdict.culprit, kFirst) << "both are 1 ms beyond: the first";
  under_way.used[kThird.index] = milliseconds(12);
  EXPECT_EQ(judged(kFirst, 121).culprit, kThird);
}

TEST_F(BlameTest, ForgetsJobsThatEndedBeforeTheReleaseBeforeTheMiss) {
  blame.ended(kSecond, milliseconds(6), milliseconds(9));
  blame.ended(kFirst, milliseconds(9), milliseconds(28));
  blame.missed(kFirst, milliseconds(20));
  EXPECT_EQ(judged(kFirst, 30).culprit, kFirst);
}

TEST_F(BlameTest, SaysNobodyWhenTheProcessorWasAway) {
  blame.ended(kFirst, milliseconds(1), milliseconds(20));
  blame.ended(kSecond, milliseconds(2), milliseconds(21));
  blame.missed(kFirst, milliseconds(10));
  under_way.used[kThird.index] = milliseconds(1);
  const Blame::Verdict verdict = judged(kFirst, 21);
  EXPECT_FALSE(verdict.culprit.is_valid());
  EXPECT_EQ(verdict.used, milliseconds(7)) << "of 11 ms that it waited, 4 were used";
}

TEST_F(BlameTest, BlamesWhoeverUsedTooMuchEvenWhenTheProcessorWasAwayToo) {
  blame.ended(kSecond, microseconds(2001), milliseconds(20));
  blame.missed(kFirst, milliseconds(10));
  EXPECT_EQ(judged(kFirst, 40).culprit, kSecond);
}

TEST_F(BlameTest, SaysWhoCameNearestWhenTheProcessorWasAwayForLessThanAMillisecond) {
  blame.ended(kFirst, milliseconds(2), milliseconds(18));
  blame.ended(kSecond, microseconds(1900), milliseconds(19));
  blame.ended(kThird, microseconds(6200), milliseconds(20));
  blame.missed(kFirst, milliseconds(10));
  const Blame::Verdict verdict = judged(kFirst, 21);
  EXPECT_EQ(verdict.culprit, kFirst);
  EXPECT_EQ(verdict.used, milliseconds(2));
}

TEST_F(BlameTest, DoesNotSayThatTheProcessorWasAwayWhenMoreJobsEndedThanAreRemembered) {
  for (int i = 0; i < 8; ++i) blame.ended(kFirst, microseconds(100), milliseconds(11 + i));
  blame.missed(kSecond, milliseconds(10));
  EXPECT_EQ(judged(kSecond, 20).culprit, kFirst);
}

TEST_F(BlameTest, WaitsFromTheFirstReleaseThatWasMissed) {
  blame.missed(kFirst, milliseconds(20));
  blame.missed(kFirst, milliseconds(10));
  blame.missed(kFirst, milliseconds(30));
  EXPECT_EQ(judged(kFirst, 35).used, milliseconds(25));
}

TEST_F(BlameTest, BlamesTheTaskItselfWhenNobodyUsedAnything) {
  const Blame::Verdict verdict = judged(kFirst, 21);
  EXPECT_EQ(verdict.culprit, kFirst) << "no release of it was missed";
  EXPECT_EQ(verdict.used, Nanoseconds{});
}

TEST_F(BlameTest, JudgesATaskTenTimesASecondAtMostAndForgetsWhatCameBetween) {
  blame.missed(kFirst, milliseconds(10));
  EXPECT_EQ(judged(kFirst, 20).used, milliseconds(10));
  blame.missed(kFirst, milliseconds(20));
  EXPECT_FALSE(blame.judge(kFirst, milliseconds(119)));
  EXPECT_TRUE(blame.judge(kSecond, milliseconds(119))) << "another task";
  blame.missed(kFirst, milliseconds(110));
  EXPECT_EQ(judged(kFirst, 120).used, milliseconds(10));
}

TEST_F(BlameTest, SaysThatAJobWaitsInASystemCall) {
  under_way.blocked = kFirst;
  under_way.used[kFirst.index] = microseconds(300);
  blame.ended(kSecond, milliseconds(2), milliseconds(15));
  blame.missed(kFirst, milliseconds(10));
  const Blame::Verdict verdict = judged(kFirst, 20);
  EXPECT_EQ(verdict.culprit, kFirst);
  EXPECT_EQ(verdict.used, microseconds(300));
  EXPECT_TRUE(verdict.is_blocked);
  blame.missed(kSecond, milliseconds(110));
  EXPECT_FALSE(judged(kSecond, 120).is_blocked) << "it is another one that waits";
}

TEST_F(BlameTest, BlamesWhoeverTookHalfOfTheTimeEvenWhenTheJobWaitsByNow) {
  under_way.blocked = kFirst;
  blame.ended(kSecond, microseconds(7001), milliseconds(15));
  blame.missed(kFirst, milliseconds(10));
  const Blame::Verdict verdict = judged(kFirst, 20);
  EXPECT_EQ(verdict.culprit, kSecond);
  EXPECT_FALSE(verdict.is_blocked);
}

TEST_F(BlameTest, DoesNotBlameALittleTooMuchForAJobThatWaits) {
  under_way.blocked = kFirst;
  blame.ended(kSecond, milliseconds(7), milliseconds(15));
  blame.missed(kFirst, milliseconds(10));
  EXPECT_TRUE(judged(kFirst, 20).is_blocked);
  blame.ended(kSecond, microseconds(2001), milliseconds(115));
  under_way.used[kThird.index] = milliseconds(6);
  blame.missed(kThird, milliseconds(110));
  EXPECT_EQ(judged(kThird, 120).culprit, kThird) << "nor for one that uses all there is";
}

// Seen at its deadline, an endless loop has not used more than its period yet.
TEST_F(BlameTest, BlamesAJobWithoutABudgetForItsOwnLateness) {
  blame.ended(kFirst, microseconds(1990), milliseconds(12));
  under_way.used[kThird.index] = milliseconds(6);
  blame.missed(kThird, milliseconds(10));
  const Blame::Verdict verdict = judged(kThird, 20);
  EXPECT_EQ(verdict.culprit, kThird) << "the first one came nearer to what it may use";
  EXPECT_EQ(verdict.used, milliseconds(6));
}

TEST_F(BlameTest, WorksWithoutThreads) {
  Blame alone(tasks, nullptr);
  alone.ended(kSecond, milliseconds(5), milliseconds(15));
  alone.missed(kFirst, milliseconds(10));
  EXPECT_EQ(alone.judge(kFirst, milliseconds(20))->culprit, kSecond);
}

}  // namespace
}  // namespace chimera
