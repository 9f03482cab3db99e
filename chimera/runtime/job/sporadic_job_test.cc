// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/job/sporadic_job.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

constexpr ServerSpec kSporadic{ServerKind::kSporadic, milliseconds(2), milliseconds(10)};
constexpr ServerSpec kDeferrable{ServerKind::kDeferrable, milliseconds(2), milliseconds(10)};

SporadicJob started(const ServerSpec& spec, Nanoseconds granularity = {}) {
  SporadicJob job(spec, granularity);
  job.start({});
  return job;
}

TEST(SporadicJob, AnswersEventsInTurn) {
  SporadicJob job = started(kSporadic);
  std::uint32_t waiting = 2;
  EXPECT_TRUE(job.accept(waiting, milliseconds(1)));
  EXPECT_EQ(waiting, 1u);
  EXPECT_EQ(job.release(), milliseconds(1));
  EXPECT_TRUE(job.accept(waiting, milliseconds(2))) << "the first one is not answered yet";
  EXPECT_EQ(waiting, 1u);
  EXPECT_EQ(job.release(), milliseconds(1));
  job.finish();
  EXPECT_FALSE(job.has_event());
  EXPECT_TRUE(job.accept(waiting, milliseconds(3)));
  EXPECT_EQ(waiting, 0u);
  EXPECT_EQ(job.release(), milliseconds(3));
  job.finish();
  EXPECT_FALSE(job.accept(waiting, milliseconds(4)));
  EXPECT_FALSE(job.has_event());
}

TEST(SporadicJob, LosesOnlyTheAcceptedEvent) {
  SporadicJob job = started(kSporadic);
  EXPECT_FALSE(job.forget());
  std::uint32_t waiting = 3;
  EXPECT_TRUE(job.accept(waiting, {}));
  EXPECT_TRUE(job.forget());
  EXPECT_EQ(waiting, 2u) << "those that wait are counted by their owner";
  EXPECT_FALSE(job.has_event());
  EXPECT_FALSE(job.forget());
}

TEST(SporadicJob, RunsUntilTheCapacityIsUsedAndAgainWhenItIsBack) {
  SporadicJob job = started(kSporadic);
  std::uint32_t waiting = 1;
  (void)job.accept(waiting, milliseconds(3));
  EXPECT_TRUE(job.grant(milliseconds(3)).may_run);
  EXPECT_EQ(job.deadline(), milliseconds(13));
  EXPECT_EQ(job.allowance(milliseconds(3)), milliseconds(2));
  job.charge(milliseconds(2));
  const SporadicJob::Grant exhausted = job.grant(milliseconds(5));
  EXPECT_FALSE(exhausted.may_run);
  EXPECT_TRUE(exhausted.has_another_deadline) << "used capacity comes back one period after the job began";
  EXPECT_EQ(job.next_change(milliseconds(5)), milliseconds(13));
  EXPECT_TRUE(job.grant(milliseconds(13)).may_run);
  EXPECT_EQ(job.deadline(), milliseconds(23));
}

TEST(SporadicJob, OnADeferrableServerIsAsUrgentAsItsPeriod) {
  SporadicJob job = started(kDeferrable);
  std::uint32_t waiting = 1;
  (void)job.accept(waiting, milliseconds(3));
  EXPECT_TRUE(job.grant(milliseconds(3)).has_another_deadline) << "the first grant";
  EXPECT_EQ(job.deadline(), milliseconds(10));
  EXPECT_FALSE(job.grant(milliseconds(9)).has_another_deadline);
  EXPECT_TRUE(job.grant(milliseconds(10)).has_another_deadline);
  EXPECT_EQ(job.deadline(), milliseconds(20));
}

TEST(SporadicJob, StaysActiveFromOneEventToTheNextOne) {
  SporadicJob job = started(kSporadic);
  std::uint32_t waiting = 2;
  (void)job.accept(waiting, milliseconds(1));
  (void)job.grant(milliseconds(1));
  job.charge(milliseconds(1));
  job.finish();
  (void)job.accept(waiting, milliseconds(2));
  (void)job.grant(milliseconds(2));
  EXPECT_EQ(job.deadline(), milliseconds(11)) << "of the piece that the first job began";
  job.finish();
  EXPECT_FALSE(job.accept(waiting, milliseconds(3)));
  waiting = 1;
  (void)job.accept(waiting, milliseconds(4));
  (void)job.grant(milliseconds(4));
  EXPECT_EQ(job.deadline(), milliseconds(14)) << "it was not active in between";
}

TEST(SporadicJob, CountsARestBelowTheGranularityAsUsed) {
  SporadicJob fine = started(kSporadic), coarse = started(kSporadic, microseconds(25));
  for (SporadicJob* job : {&fine, &coarse}) {
    std::uint32_t waiting = 1;
    (void)job->accept(waiting, {});
    (void)job->grant({});
    job->charge(microseconds(1990));
  }
  EXPECT_TRUE(fine.grant(milliseconds(2)).may_run);
  EXPECT_FALSE(coarse.grant(milliseconds(2)).may_run);
  EXPECT_TRUE(coarse.grant(milliseconds(10)).may_run);
  EXPECT_EQ(coarse.allowance(milliseconds(10)), milliseconds(2)) << "it came back with the whole";
}

TEST(SporadicJob, KeepsAQuarterOfASmallCapacity) {
  SporadicJob job = started({ServerKind::kSporadic, microseconds(40), milliseconds(10)}, microseconds(25));
  std::uint32_t waiting = 1;
  (void)job.accept(waiting, {});
  (void)job.grant({});
  job.charge(microseconds(29));
  EXPECT_TRUE(job.grant(microseconds(30)).may_run) << "11 us are left, a quarter is 10";
  job.charge(microseconds(2));
  EXPECT_FALSE(job.grant(microseconds(32)).may_run);
}

}  // namespace
}  // namespace chimera
