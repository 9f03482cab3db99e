// SPDX-License-Identifier: Apache-2.0
// The executive in real time against non-preemptive virtual time: the same set, the same schedule, unit by unit.
#include <gtest/gtest.h>

#include "chimera/runtime/executive/counter_clock.h"
#include "tests/conformance/classic_set.h"

namespace chimera::toy {
namespace {

Schedule by_virtual_time(Policy policy) {
  Application app;
  add_classic_set(app, true, {}, OnMiss::kContinue);
  Runner run(app.build(), Kind::kVirtual, policy);
  EXPECT_TRUE(run.start());
  run.run(kUnit * kUnits);
  Schedule schedule;
  schedule.timeline = timeline(run.records(), Nanoseconds{} - kHalfAfter);
  return schedule;
}

Schedule by_one_loop(Policy policy) {
  Application app;
  add_classic_set(app, false, {}, OnMiss::kContinue);
  TaskSet& set = app.build();
  app.calls.reserve(1000);
  Nanoseconds origin;
  for (const char* name : {"A", "B", "C", "D"})
    app.toy(name).during = [&origin, work = app.task(name).spec->budget](const chimera_call& call) {
      return compute(call, origin, work, false);
    };
  auto ring = std::make_unique<TapRing>();
  Tap tap(*ring);
  TapReader reader(*ring);
  RunOptions options;
  options.policy = policy;
  options.tap = &tap;
  CounterClock clock;
  ComputingClock job_clock(clock);
  Executive executive(set, clock, job_clock, options);
  std::thread loop([&] {
    (void)enter_realtime({kCeiling, last_cpu(), false});
    if (!executive.start()) return;
    origin = executive.origin();
    executive.run(kUnit * kUnits);
  });
  loop.join();
  std::vector<TapRecord> records(kTapRecords);
  records.resize(reader.read(records));
  Schedule schedule;
  schedule.timeline = timeline(records, origin);
  return schedule;
}

class ExecutiveSchedule : public testing::TestWithParam<Policy> {};

TEST_P(ExecutiveSchedule, IsThatOfVirtualTimeUnitByUnit) {
  const Schedule wanted = by_virtual_time(GetParam());
  const auto got = judged([] { return by_one_loop(GetParam()); });
  if (!got) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(got->timeline, wanted.timeline);
}

INSTANTIATE_TEST_SUITE_P(Of, ExecutiveSchedule,
                         testing::Values(Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity), name_of);

}  // namespace
}  // namespace chimera::toy
