// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/job/miss_cause.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera::miss_cause_test {
namespace {

constexpr TaskId kFirst{0u}, kSecond{1u}, kThird{2u};

/// Jobs that are under way, by task.
class JobsUnderWay final : public JobsInLoop {
 public:
  JobsUnderWay() : JobsInLoop({}, nullptr) {}
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
class MissCauseTest : public ::testing::Test {
 protected:
  MissCauseTest() {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      specs[i].period = specs[i].deadline = milliseconds(10);
      specs[i].budget = i < 2 ? milliseconds(2) : Nanoseconds{};
      tasks[i].id = TaskId(i);
      tasks[i].spec = &specs[i];
    }
  }
  MissCause::Verdict judged(TaskId missed, std::int64_t now_ms) {
    const auto verdict = cause.judge(missed, milliseconds(now_ms));
    EXPECT_TRUE(verdict);
    return verdict ? *verdict : MissCause::Verdict{};
  }

  std::array<TaskSpec, 3> specs;
  std::array<Task, 3> tasks;
  JobsUnderWay under_way;
  HeapMemory heap;
  MissCause cause{tasks, under_way, heap};
};

TEST_F(MissCauseTest, FindsTheTaskThatExceededItsBudgetMost) {
  cause.ended(kFirst, milliseconds(3), milliseconds(13));
  cause.ended(kSecond, milliseconds(6), milliseconds(19));
  cause.missed(kFirst, milliseconds(10));
  const MissCause::Verdict verdict = judged(kFirst, 21);
  EXPECT_EQ(verdict.culprit, kSecond);
  EXPECT_EQ(verdict.used, milliseconds(6));
}

TEST_F(MissCauseTest, MeasuresATaskWithoutABudgetByItsPeriod) {
  cause.ended(kThird, milliseconds(9), milliseconds(15));
  cause.ended(kFirst, microseconds(2100), milliseconds(18));
  cause.missed(kSecond, milliseconds(10));
  EXPECT_EQ(judged(kSecond, 21).culprit, kFirst) << "9 ms of 10 are within, 2.1 of 2 are not";
}

TEST_F(MissCauseTest, CountsAJobThatIsUnderWay) {
  under_way.used[kThird.index] = milliseconds(11);
  cause.ended(kFirst, milliseconds(3), milliseconds(13));
  cause.missed(kFirst, milliseconds(10));
  const MissCause::Verdict verdict = judged(kFirst, 21);
  EXPECT_EQ(verdict.culprit, kFirst) << "both are 1 ms beyond: the first";
  under_way.used[kThird.index] = milliseconds(12);
  EXPECT_EQ(judged(kFirst, 121).culprit, kThird);
}

TEST_F(MissCauseTest, ForgetsJobsThatEndedBeforeTheReleaseBeforeTheMiss) {
  cause.ended(kSecond, milliseconds(6), milliseconds(9));
  cause.ended(kFirst, milliseconds(9), milliseconds(28));
  cause.missed(kFirst, milliseconds(20));
  EXPECT_EQ(judged(kFirst, 30).culprit, kFirst);
}

TEST_F(MissCauseTest, BlamesNoTaskWhenTheProcessorWasAway) {
  cause.ended(kFirst, milliseconds(1), milliseconds(20));
  cause.ended(kSecond, milliseconds(2), milliseconds(21));
  cause.missed(kFirst, milliseconds(10));
  under_way.used[kThird.index] = milliseconds(1);
  const MissCause::Verdict verdict = judged(kFirst, 21);
  EXPECT_FALSE(verdict.culprit.is_valid());
  EXPECT_EQ(verdict.used, milliseconds(7)) << "of 11 ms that it waited, 4 were used";
}

TEST_F(MissCauseTest, BlamesATaskThatUsedTooMuchThoughTheProcessorWasAway) {
  cause.ended(kSecond, microseconds(2001), milliseconds(20));
  cause.missed(kFirst, milliseconds(10));
  EXPECT_EQ(judged(kFirst, 40).culprit, kSecond);
}

TEST_F(MissCauseTest, BlamesTheNearestTaskIfTheProcessorWasAwayForLessThanAMillisecond) {
  cause.ended(kFirst, milliseconds(2), milliseconds(18));
  cause.ended(kSecond, microseconds(1900), milliseconds(19));
  cause.ended(kThird, microseconds(6200), milliseconds(20));
  cause.missed(kFirst, milliseconds(10));
  const MissCause::Verdict verdict = judged(kFirst, 21);
  EXPECT_EQ(verdict.culprit, kFirst);
  EXPECT_EQ(verdict.used, milliseconds(2));
}

TEST_F(MissCauseTest, DoesNotSayThatTheProcessorWasAwayWhenMoreJobsEndedThanAreRemembered) {
  for (int i = 0; i < 8; ++i) cause.ended(kFirst, microseconds(100), milliseconds(11 + i));
  cause.missed(kSecond, milliseconds(10));
  EXPECT_EQ(judged(kSecond, 20).culprit, kFirst);
}

TEST_F(MissCauseTest, WaitsFromTheFirstReleaseThatWasMissed) {
  cause.missed(kFirst, milliseconds(20));
  cause.missed(kFirst, milliseconds(10));
  cause.missed(kFirst, milliseconds(30));
  EXPECT_EQ(judged(kFirst, 35).used, milliseconds(25));
}

TEST_F(MissCauseTest, BlamesTheTaskItselfWhenNoTaskUsedTime) {
  const MissCause::Verdict verdict = judged(kFirst, 21);
  EXPECT_EQ(verdict.culprit, kFirst) << "no release of it was missed";
  EXPECT_EQ(verdict.used, Nanoseconds{});
}

TEST_F(MissCauseTest, JudgesATaskTenTimesASecondAtMostAndForgetsOtherMisses) {
  cause.missed(kFirst, milliseconds(10));
  EXPECT_EQ(judged(kFirst, 20).used, milliseconds(10));
  cause.missed(kFirst, milliseconds(20));
  EXPECT_FALSE(cause.judge(kFirst, milliseconds(119)));
  EXPECT_TRUE(cause.judge(kSecond, milliseconds(119))) << "another task";
  cause.missed(kFirst, milliseconds(110));
  EXPECT_EQ(judged(kFirst, 120).used, milliseconds(10));
}

TEST_F(MissCauseTest, SaysThatAJobWaitsInASystemCall) {
  under_way.blocked = kFirst;
  under_way.used[kFirst.index] = microseconds(300);
  cause.ended(kSecond, milliseconds(2), milliseconds(15));
  cause.missed(kFirst, milliseconds(10));
  const MissCause::Verdict verdict = judged(kFirst, 20);
  EXPECT_EQ(verdict.culprit, kFirst);
  EXPECT_EQ(verdict.used, microseconds(300));
  EXPECT_TRUE(verdict.is_blocked);
  cause.missed(kSecond, milliseconds(110));
  EXPECT_FALSE(judged(kSecond, 120).is_blocked) << "another job waits";
}

TEST_F(MissCauseTest, BlamesTheTaskThatTookHalfOfTheTimeThoughTheJobIsBlocked) {
  under_way.blocked = kFirst;
  cause.ended(kSecond, microseconds(7001), milliseconds(15));
  cause.missed(kFirst, milliseconds(10));
  const MissCause::Verdict verdict = judged(kFirst, 20);
  EXPECT_EQ(verdict.culprit, kSecond);
  EXPECT_FALSE(verdict.is_blocked);
}

TEST_F(MissCauseTest, DoesNotBlameALittleTooMuchForAJobThatWaits) {
  under_way.blocked = kFirst;
  cause.ended(kSecond, milliseconds(7), milliseconds(15));
  cause.missed(kFirst, milliseconds(10));
  EXPECT_TRUE(judged(kFirst, 20).is_blocked);
  cause.ended(kSecond, microseconds(2001), milliseconds(115));
  under_way.used[kThird.index] = milliseconds(6);
  cause.missed(kThird, milliseconds(110));
  EXPECT_EQ(judged(kThird, 120).culprit, kThird) << "nor for one that uses all there is";
}

// Seen at its deadline, an endless loop has not used more than its period yet.
TEST_F(MissCauseTest, BlamesAJobWithoutABudgetForItsOwnLateness) {
  cause.ended(kFirst, microseconds(1990), milliseconds(12));
  under_way.used[kThird.index] = milliseconds(6);
  cause.missed(kThird, milliseconds(10));
  const MissCause::Verdict verdict = judged(kThird, 20);
  EXPECT_EQ(verdict.culprit, kThird) << "the first task came nearer to its budget";
  EXPECT_EQ(verdict.used, milliseconds(6));
}

TEST_F(MissCauseTest, WorksWithoutThreads) {
  JobsInLoop in_loop(tasks, nullptr);
  MissCause alone(tasks, in_loop, heap);
  alone.ended(kSecond, milliseconds(5), milliseconds(15));
  alone.missed(kFirst, milliseconds(10));
  EXPECT_EQ(alone.judge(kFirst, milliseconds(20))->culprit, kSecond);
}

}  // namespace
}  // namespace chimera::miss_cause_test
