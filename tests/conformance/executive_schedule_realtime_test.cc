// SPDX-License-Identifier: Apache-2.0
// The executive in real time against non-preemptive virtual time: the same set, the same schedule, unit by unit.
#include <gtest/gtest.h>

#include "chimera/runtime/executive/counter_clock.h"
#include "tests/conformance/by_threads.h"
#include "tests/conformance/classic_set.h"
#include "tests/conformance/judged.h"

namespace chimera::toy {
namespace {

Schedule by_one_loop(Policy policy) {
  Application app;
  add_classic_set(app, false, OnMiss::kContinue);
  TaskSet& set = app.build();
  app.calls.reserve(1000);
  Listened listened;
  RunOptions options;
  options.policy = policy;
  options.tap = listened.tap();
  CounterClock clock;
  ComputingClock job_clock(clock);
  Executive executive(set, clock, job_clock, options);
  at_the_ceiling([&] {
    if (executive.start()) executive.run(kUnit * kUnits);
  });
  return schedule_of(listened.records(), executive.origin());
}

class ExecutiveSchedule : public ::testing::TestWithParam<Policy> {};

TEST_P(ExecutiveSchedule, IsThatOfVirtualTimeUnitByUnit) {
  const Schedule wanted = by_virtual_time(Kind::kVirtual, GetParam(), OnMiss::kContinue);
  const auto got = judged(kGap, [] { return by_one_loop(GetParam()); });
  if (!got) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(got->timeline, wanted.timeline);
}

INSTANTIATE_TEST_SUITE_P(Of, ExecutiveSchedule,
                         ::testing::Values(Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity), name_of);

}  // namespace
}  // namespace chimera::toy
