// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/utilisation.h"

#include <gtest/gtest.h>

#include <vector>

namespace chimera {
namespace {

TaskSpec task(std::string_view name, Nanoseconds period, Nanoseconds budget, std::uint32_t rtpu = 0) {
  TaskSpec t;
  t.name = name;
  t.period = t.deadline = period;
  t.budget = budget;
  t.rtpu = RtpuId(rtpu);
  return t;
}

// The classic set of the MUF literature: 1.25 of a processor.
const std::vector<TaskSpec> kSet = {
    task("A", milliseconds(6), milliseconds(2)), task("B", milliseconds(10), milliseconds(4)),
    task("C", milliseconds(12), milliseconds(3)), task("D", milliseconds(15), milliseconds(4))};
const std::vector<TaskId> kAll = {TaskId(0u), TaskId(1u), TaskId(2u), TaskId(3u)};
const std::vector<std::uint32_t> kOneCpu = {2};

TEST(Utilisation, AddsBudgetOverPeriodOfTheTasksThatAreOn) {
  const Utilisation u = utilisation(kSet, kAll, kOneCpu, 2);
  EXPECT_NEAR(u.sum, 1.25, 1e-12);
  EXPECT_EQ(u.largest, TaskId(1u));
  EXPECT_NEAR(utilisation(kSet, std::vector{TaskId(3u)}, kOneCpu, 2).sum, 4.0 / 15, 1e-12);
}

TEST(Utilisation, CountsTasksThatStateNoBudget) {
  const std::vector<TaskSpec> set = {task("A", milliseconds(6), {}), task("B", milliseconds(10), milliseconds(1))};
  const Utilisation u = utilisation(set, std::vector{TaskId(0u), TaskId(1u)}, kOneCpu, 2);
  EXPECT_EQ(u.unstated, 1u);
  EXPECT_NEAR(u.sum, 0.1, 1e-12);
}

TEST(Utilisation, RefusesWithTheSumTheLargestTaskAndTheBudgetThatFits) {
  const auto verdict = admit(kSet, kAll, kOneCpu);
  ASSERT_FALSE(verdict);
  EXPECT_EQ(verdict.error().code, ErrorCode::kRefused);
  EXPECT_EQ(verdict.error().where.view(), "cpu 2");
  EXPECT_EQ(verdict.error().message.view(),
            "the tasks that go ON ask for 1.250 of the processor, at most 0.930 can be promised; the largest is 'B' "
            "with 0.400 (4 ms every 10 ms), which fits with a budget of at most 800 us");
}

TEST(Utilisation, NamesNoBudgetWhenTheOthersAloneAreTooMuch) {
  const std::vector<TaskSpec> set = {task("A", milliseconds(10), milliseconds(10)),
                                     task("B", milliseconds(10), milliseconds(10))};
  const auto verdict = admit(set, std::vector{TaskId(0u), TaskId(1u)}, kOneCpu);
  ASSERT_FALSE(verdict);
  EXPECT_EQ(verdict.error().message.view(),
            "the tasks that go ON ask for 2.000 of the processor, at most 0.930 can be promised; the largest is 'A' "
            "with 1.000 (10 ms every 10 ms)");
}

TEST(Utilisation, AdmitsExactlyTheLimitAndRefusesJustAbove) {
  std::vector<TaskSpec> set = {task("A", milliseconds(100), milliseconds(93))};
  const std::vector<TaskId> on = {TaskId(0u)};
  EXPECT_TRUE(admit(set, on, kOneCpu));
  set[0].budget += microseconds(1);
  const auto verdict = admit(set, on, kOneCpu);
  ASSERT_FALSE(verdict);
  EXPECT_NE(verdict.error().message.view().find("ask for 0.931 "), std::string_view::npos);
}

TEST(Utilisation, AddsRtpusThatShareAProcessorAndKeepsOthersApart) {
  const std::vector<TaskSpec> set = {task("A", milliseconds(10), milliseconds(6), 0),
                                     task("B", milliseconds(10), milliseconds(6), 1)};
  const std::vector<TaskId> on = {TaskId(0u), TaskId(1u)};
  EXPECT_TRUE(admit(set, on, std::vector<std::uint32_t>{0, 1}));
  EXPECT_FALSE(admit(set, on, std::vector<std::uint32_t>{1, 1}));
}

}  // namespace
}  // namespace chimera
