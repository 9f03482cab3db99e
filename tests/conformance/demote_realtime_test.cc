// SPDX-License-Identifier: Apache-2.0
// A job that uses too much under the reaction demote: the others have the same schedule as in virtual time.
#include <gtest/gtest.h>

#include "tests/conformance/by_threads.h"
#include "tests/conformance/classic_set.h"
#include "tests/conformance/judged.h"

namespace chimera::toy {
namespace {

constexpr const char* kNames[] = {"A", "B", "C"};
constexpr int kUnitsOfWork[] = {3, 1, 5};

struct Outcome {
  std::string others;  // the timeline without A
  Profile of[3];
};

// A goes first and uses three times what it may.
void add_set(Application& app, bool in_virtual_time, Nanoseconds grace) {
  constexpr int kPeriods[] = {20, 5, 10};
  for (int i = 0; i < 3; ++i) {
    const Nanoseconds work = kUnit * kUnitsOfWork[i];
    TaskSpec& spec = app.add(kNames[i], kUnit * kPeriods[i], in_virtual_time ? work : Nanoseconds{});
    spec.deadline = spec.period + grace;
    spec.budget = work + (in_virtual_time ? Nanoseconds{} : kHalf);
    spec.criticality = i == 0 ? 2 : 1;
    if (in_virtual_time) continue;
    app.toy(kNames[i]).during = [work](const chimera_call& call) { return compute(call, work, false); };
  }
  app.spec("A").budget = kUnit + (in_virtual_time ? Nanoseconds{} : kAfter);
  app.spec("A").on_overrun = OnMiss::kDemote;
}

Outcome outcome(const Application& app, const std::vector<TapRecord>& records, Nanoseconds origin) {
  Outcome seen;
  seen.others = classic_timeline(records, origin, ".BC");
  for (int i = 0; i < 3; ++i) seen.of[i] = app.task(kNames[i]).profile;
  return seen;
}

Outcome by_virtual_time() {
  Application app;
  add_set(app, true, {});
  Runner run(app.build(), Kind::kPreemptive, Policy::kMuf);
  EXPECT_TRUE(run.start());
  run.run(kUnit * kUnits);
  return outcome(app, run.records(), {});
}

Outcome by_threads() {
  Application app;
  add_set(app, false, kGrace);
  const Left left = run_by_threads(app, Policy::kMuf, kUnit * kUnits);
  EXPECT_EQ(left.counts.wrong_levels, 0u);
  return outcome(app, left.records, left.origin);
}

TEST(DemotedSchedule, LeavesTheOthersThatOfVirtualTimeUnitByUnit) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  const Outcome wanted = by_virtual_time();
  EXPECT_EQ(wanted.others.substr(0, 20), ".BCCCCCB..BCCCCCB...");
  const auto seen = judged(kGap, by_threads);
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(seen->others, wanted.others);
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(kNames[i]);
    EXPECT_EQ(seen->of[i].demoted, wanted.of[i].demoted);
    EXPECT_EQ(seen->of[i].overrun, wanted.of[i].overrun);
    if (i == 0) continue;  // when it ends is the choice of the system, which runs it like anything else
    EXPECT_EQ(seen->of[i].preempted, wanted.of[i].preempted);
    EXPECT_EQ(seen->of[i].cycles, wanted.of[i].cycles);
    EXPECT_EQ(seen->of[i].missed, wanted.of[i].missed);
  }
}

}  // namespace
}  // namespace chimera::toy
