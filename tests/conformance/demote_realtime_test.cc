// SPDX-License-Identifier: Apache-2.0
// A job that uses too much under the reaction demote: the others have the same schedule as in virtual time.
#include <gtest/gtest.h>

#include "tests/conformance/classic_set.h"

namespace chimera::toy {
namespace {

constexpr const char* kNames[] = {"A", "B", "C"};
constexpr int kUnitsOfWork[] = {3, 1, 5};

struct Outcome {
  std::string others;  // the timeline without A
  Profile of[3];
};

// A goes first and uses three times what it may.
void add_set(Application& app, bool in_units, Nanoseconds grace) {
  constexpr int kPeriods[] = {20, 5, 10};
  for (int i = 0; i < 3; ++i) {
    TaskSpec& spec = app.add(kNames[i], kUnit * kPeriods[i], in_units ? kUnit * kUnitsOfWork[i] : Nanoseconds{});
    spec.deadline = spec.period + grace;
    spec.budget = kUnit * kUnitsOfWork[i] + (in_units ? Nanoseconds{} : kHalf);
    spec.criticality = i == 0 ? 2 : 1;
  }
  app.spec("A").budget = kUnit + (in_units ? Nanoseconds{} : kAfter);
  app.spec("A").on_overrun = OnMiss::kDemote;
}

Outcome outcome(const Application& app, const std::vector<TapRecord>& records, Nanoseconds origin) {
  Outcome seen;
  seen.others = timeline(records, origin);
  std::replace(seen.others.begin(), seen.others.end(), 'A', '.');
  for (int i = 0; i < 3; ++i) seen.of[i] = app.task(kNames[i]).profile;
  return seen;
}

Outcome by_virtual_time() {
  Application app;
  add_set(app, true, {});
  Runner run(app.build(), Kind::kPreemptive, Policy::kMuf);
  EXPECT_TRUE(run.start());
  run.run(kUnit * kUnits);
  return outcome(app, run.records(), Nanoseconds{} - kHalfAfter);
}

Outcome by_threads() {
  Application app;
  add_set(app, false, kGrace);
  auto ring = std::make_unique<TapRing>();
  Tap tap(*ring);
  TapReader reader(*ring);
  RunOptions options;
  options.policy = Policy::kMuf;
  options.tap = &tap;
  TaskSet& set = app.build_preemptive();
  Nanoseconds origin;
  for (int i = 0; i < 3; ++i)
    app.toy(kNames[i]).during = [&origin, work = kUnit * kUnitsOfWork[i]](const chimera_call& call) {
      return compute(call, origin, work, false);
    };
  ProcessorPlace place;
  place.cpu = last_cpu();
  place.ceiling = kCeiling;
  place.base = 30;
  place.checks = true;
  PreemptiveExecutor executor(set, options, place);
  std::thread edges([&] {
    enter_realtime({kCeiling, last_cpu(), false});
    if (!executor.start()) return;
    origin = executor.origin();
    executor.run(kUnit * kUnits);
  });
  edges.join();
  EXPECT_EQ(executor.counts().wrong_levels, 0u);
  std::vector<TapRecord> records(kTapRecords);
  records.resize(reader.read(records));
  return outcome(app, records, executor.origin());
}

TEST(DemotedSchedule, LeavesTheOthersThatOfVirtualTimeUnitByUnit) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  const Outcome wanted = by_virtual_time();
  EXPECT_EQ(wanted.others.substr(0, 20), ".BCCCCCB..BCCCCCB...");
  Outcome seen;
  const auto got = judged([&seen] {
    seen = by_threads();
    return Schedule{};
  });
  if (!got) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(seen.others, wanted.others);
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(kNames[i]);
    EXPECT_EQ(seen.of[i].demoted, wanted.of[i].demoted);
    EXPECT_EQ(seen.of[i].overrun, wanted.of[i].overrun);
    if (i == 0) continue;  // when it ends is the choice of the system, which runs it like anything else
    EXPECT_EQ(seen.of[i].preempted, wanted.of[i].preempted);
    EXPECT_EQ(seen.of[i].cycles, wanted.of[i].cycles);
    EXPECT_EQ(seen.of[i].missed, wanted.of[i].missed);
  }
}

}  // namespace
}  // namespace chimera::toy
