// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/preemptive/processor_share.h"

#include <gtest/gtest.h>

#include <array>

namespace chimera::processor_share_test {
namespace {

constexpr Nanoseconds kNow = seconds(1000);
constexpr TaskId kImportant(0u), kLess(1u);

class ProcessorShareTest : public ::testing::Test {
 protected:
  ProcessorShareTest() {
    for (std::uint32_t i = 0; i < 3; ++i) {
      specs_[i].period = milliseconds(i == 1 ? 20 : 10);
      tasks_[i].spec = &specs_[i];
      tasks_[i].id = TaskId(i);
    }
    specs_[0].criticality = 2;
    specs_[0].budget = milliseconds(3);  // 0.3 of the processor
    specs_[1].criticality = 1;
    specs_[2].criticality = 9;
  }
  ProcessorShare share(Policy policy = Policy::kMuf) {
    return {tasks_, {true, true, false}, policy, {milliseconds(900), seconds(1)}};
  }
  static void run(ProcessorShare& share, TaskId task, Nanoseconds from, Nanoseconds time) {
    share.set_running(task, from);
    share.set_running(TaskId(), from + time);
  }

  std::array<TaskSpec, 3> specs_;
  std::array<Task, 3> tasks_;
};

TEST_F(ProcessorShareTest, KeepsTheBudgetsOfImportantTasksFree) {
  ProcessorShare s = share();
  EXPECT_EQ(s.left(kNow), milliseconds(600));
  run(s, kLess, kNow, milliseconds(250));
  EXPECT_EQ(s.left(kNow + milliseconds(250)), milliseconds(350));
  run(s, kImportant, kNow + milliseconds(250), milliseconds(200));
  EXPECT_EQ(s.left(kNow + milliseconds(450)), milliseconds(350)) << "that was kept for it";
  run(s, kImportant, kNow + milliseconds(450), milliseconds(150));
  EXPECT_EQ(s.left(kNow + milliseconds(600)), milliseconds(300)) << "it used more";
}

TEST_F(ProcessorShareTest, DemotesLessImportantTasksFirst) {
  ProcessorShare s = share();
  run(s, kLess, kNow, milliseconds(600));
  const Nanoseconds now = kNow + milliseconds(600);
  EXPECT_LE(s.left(now), Nanoseconds{});
  EXPECT_TRUE(s.may_demote(kLess, false, true, now));
  EXPECT_FALSE(s.may_demote(kImportant, true, false, now)) << "the share is not used up";
}

TEST_F(ProcessorShareTest, DemotesAnImportantOneOnlyWhenAllIsUsedUp) {
  ProcessorShare s = share();
  run(s, kImportant, kNow, milliseconds(900));
  const Nanoseconds now = kNow + milliseconds(900);
  EXPECT_FALSE(s.may_demote(kImportant, false, true, now)) << "the most urgent job within its budget goes on";
  EXPECT_TRUE(s.may_demote(kImportant, true, true, now));
  EXPECT_TRUE(s.may_demote(kImportant, false, false, now));
}

TEST_F(ProcessorShareTest, RanksByThePeriodUnderRateMonotonicAndNotAtAllByDeadlines) {
  ProcessorShare rm = share(Policy::kRm), edf = share(Policy::kEdf);
  EXPECT_TRUE(rm.may_demote(kLess, false, true, kNow));
  EXPECT_FALSE(rm.may_demote(kImportant, true, false, kNow));
  EXPECT_FALSE(edf.may_demote(kLess, true, false, kNow));
  specs_[1].period = specs_[0].period;
  ProcessorShare equal = share(Policy::kRm);
  EXPECT_FALSE(equal.may_demote(kLess, true, false, kNow)) << "none is the slowest";
}

TEST_F(ProcessorShareTest, LooksOnlyAtTheTasksOfTheProcessor) {
  specs_[0].criticality = 1;
  ProcessorShare s = share();
  EXPECT_FALSE(s.may_demote(kLess, true, false, kNow)) << "the more critical one runs elsewhere";
}

TEST_F(ProcessorShareTest, ReportsOneDemotionASecond) {
  ProcessorShare s = share();
  EXPECT_FALSE(s.pop_demoted().is_valid());
  EXPECT_TRUE(s.note_demoted(kLess, kNow));
  EXPECT_FALSE(s.note_demoted(kImportant, kNow + milliseconds(999)));
  EXPECT_EQ(s.pop_demoted(), kLess);
  EXPECT_FALSE(s.pop_demoted().is_valid()) << "once";
  EXPECT_TRUE(s.note_demoted(kImportant, kNow + seconds(1)));
  EXPECT_EQ(s.pop_demoted(), kImportant);
}

TEST_F(ProcessorShareTest, CountsNothingWithoutALimit) {
  ProcessorShare s(tasks_, {true, true, false}, Policy::kMuf, {kNever, seconds(1)});
  EXPECT_FALSE(s.is_limited());
  run(s, kImportant, kNow, milliseconds(900));
  EXPECT_EQ(s.used(kNow + seconds(1)), Nanoseconds{});
}

}  // namespace
}  // namespace chimera::processor_share_test
