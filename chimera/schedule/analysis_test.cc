// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/analysis.h"

#include <gtest/gtest.h>

#include <vector>

namespace chimera {
namespace {

Work work(std::int64_t period, std::int64_t time, std::int64_t deadline = 0, std::uint32_t criticality = 0) {
  return {.period = milliseconds(period), .deadline = milliseconds(deadline > 0 ? deadline : period), .offset = {},
          .time = milliseconds(time), .criticality = criticality, .user_priority = 0, .rtpu = 0, .server = {}};
}

struct Judged {
  Judged(const std::vector<Work>& works, const std::vector<ProcessorUse>& uses, std::uint32_t cpu = 0)
      : verdicts(works.size()), room(works.size()), at(analyse(works, uses, cpu, verdicts, room)) {}
  std::int64_t response(std::size_t i) const { return verdicts[i].response.count / 1'000'000; }
  bool is_promised(std::size_t i) const { return verdicts[i].guarantee == Guarantee::kYes; }

  std::vector<WorkVerdict> verdicts;
  std::vector<RankedWork> room;
  CpuVerdict at;
};

ProcessorUse use(Policy policy, Dispatch dispatch = Dispatch::kPreemptive) {
  return {.cpu = 0, .criticality = 0, .policy = policy, .dispatch = dispatch};
}

TEST(Analysis, GivesTheResponsesOfTheTextbookUnderRateMonotonic) {
  // Burns & Wellings, "Real-Time Systems and Programming Languages": periods 7 12 20, times 3 3 5.
  const Judged j({work(7, 3), work(12, 3), work(20, 5)}, {use(Policy::kRm)});
  EXPECT_EQ(j.response(0), 3);
  EXPECT_EQ(j.response(1), 6);
  EXPECT_EQ(j.response(2), 20);
  EXPECT_TRUE(j.verdicts[2].is_exact);
  EXPECT_TRUE(j.at.fits());
  EXPECT_NEAR(j.at.rate_monotonic_bound, 0.7798, 1e-4);
  EXPECT_GT(j.at.utilisation, j.at.rate_monotonic_bound);  // above the bound, but schedulable
}

TEST(Analysis, GivesTheBoundsOfLiuAndLaylandAndTheHyperbolicOne) {
  const Judged j({work(4, 1), work(8, 2)}, {use(Policy::kRm)});
  EXPECT_NEAR(j.at.utilisation, 0.5, 1e-12);
  EXPECT_NEAR(j.at.rate_monotonic_bound, 0.828427, 1e-6);
  EXPECT_NEAR(j.at.hyperbolic, 1.5625, 1e-12);
}

TEST(Analysis, FindsTheIntervalInWhichConstrainedDeadlinesAskForTooMuch) {
  const Judged good({work(4, 2), work(6, 2, 5)}, {use(Policy::kEdf)});
  EXPECT_TRUE(good.at.fits());
  const Judged bad({work(10, 3, 4), work(10, 3, 5)}, {use(Policy::kEdf)});
  EXPECT_EQ(bad.at.not_guaranteed, 2u);
  EXPECT_EQ(bad.at.demand.within, milliseconds(5));
  EXPECT_EQ(bad.at.demand.ends, milliseconds(6));
}

TEST(Analysis, PromisesTheCriticalSetOfTheMufLiteratureAndNotTheRest) {
  const std::vector<Work> works = {work(6, 2, 0, 2), work(10, 4, 0, 2), work(12, 3, 0, 2), work(15, 4, 0, 0)};
  const Judged muf(works, {use(Policy::kMuf)});
  EXPECT_TRUE(muf.is_promised(0) && muf.is_promised(1) && muf.is_promised(2));
  EXPECT_FALSE(muf.is_promised(3));
  EXPECT_NEAR(muf.at.utilisation, 1.25, 1e-9);
  EXPECT_EQ(muf.verdicts[3].level, 1u);
  EXPECT_EQ(Judged(works, {use(Policy::kEdf)}).at.guaranteed, 0u);
}

TEST(Analysis, CountsTheLongestLaterJobInAnExecutive) {
  const std::vector<Work> works = {work(10, 2), work(50, 9)};
  const Judged loop(works, {use(Policy::kRm, Dispatch::kExecutive)});
  EXPECT_EQ(loop.verdicts[0].blocking, milliseconds(9) - Nanoseconds{1});
  EXPECT_FALSE(loop.is_promised(0));
  EXPECT_TRUE(Judged(works, {use(Policy::kRm)}).at.fits());
  EXPECT_FALSE(Judged(works, {use(Policy::kEdf, Dispatch::kExecutive)}).is_promised(0));
}

TEST(Analysis, LetsADeferrableServerRunTwiceBackToBackAndASporadicOneNot) {
  // Capacity 2, period 5, with a task of 3 behind the server. The deferrable server takes 2 + 2 within 7, the sporadic
  // one 2 within 5.
  std::vector<Work> works = {work(5, 2), work(10, 3)};
  works[0].server = ServerKind::kDeferrable;
  EXPECT_EQ(Judged(works, {use(Policy::kRm)}).response(1), 7);
  works[0].server = ServerKind::kSporadic;
  EXPECT_EQ(Judged(works, {use(Policy::kRm)}).response(1), 5);
}

TEST(Analysis, AddsTheTasksOfAHigherBandToThoseOfALowerOne) {
  std::vector<Work> works = {work(10, 4), work(20, 5)};
  works[1].rtpu = 1;
  std::vector<ProcessorUse> uses = {use(Policy::kEdf), use(Policy::kEdf)};
  EXPECT_EQ(Judged(works, uses).response(1), 9);
  uses[1].criticality = 2;  // now its band is the higher one
  EXPECT_EQ(Judged(works, uses).response(0), 9);
  uses[1].cpu = 1;
  EXPECT_EQ(Judged(works, uses).at.tasks, 1u);
  EXPECT_EQ(Judged(works, uses, 1).at.tasks, 1u);
}

TEST(Analysis, TakesAQuantumForEachOtherTaskOfALaxityLevel) {
  std::vector<ProcessorUse> uses = {use(Policy::kLlf)};
  uses[0].quantum = milliseconds(1);
  EXPECT_TRUE(Judged({work(10, 4), work(12, 4)}, uses).at.fits());
  uses[0].quantum = milliseconds(9);
  EXPECT_FALSE(Judged({work(10, 4), work(12, 4), work(12, 3)}, uses).at.fits());
}

TEST(Analysis, CountsTasksWithoutAStatedTime) {
  const Judged j({work(10, 0), work(20, 5)}, {use(Policy::kRm)});
  EXPECT_EQ(j.verdicts[0].guarantee, Guarantee::kNotStated);
  EXPECT_EQ(j.at.unstated, 1u);
  EXPECT_TRUE(j.is_promised(1));
}

TEST(Analysis, RefusesATimeBeyondTheDeadline) {
  const Judged j({work(10, 30)}, {use(Policy::kRm)});
  EXPECT_FALSE(j.is_promised(0));
  EXPECT_NEAR(j.at.utilisation, 3.0, 1e-9);
}

}  // namespace
}  // namespace chimera
