// SPDX-License-Identifier: Apache-2.0
// The executive on the virtual twin of its clock and non-preemptive virtual time must make the same schedule, record
// by record; and every run of virtual time must repeat to the byte.
#include <gtest/gtest.h>

#include "tests/conformance/random_toys.h"
#include "tests/conformance/runner.h"

namespace chimera::toy::twins_test {
namespace {

struct Outcome {
  std::vector<std::string> records;
  std::vector<std::string> calls;
};

Outcome run(std::uint32_t seed, Kind kind, const VirtualOptions& how = {}, bool has_events = false) {
  Dice dice(seed);
  Application app;
  fill(app, dice);
  constexpr Policy kPolicies[] = {Policy::kEdf, Policy::kRm, Policy::kMuf, Policy::kMufLaxity, Policy::kLlf};
  const Policy policy = kPolicies[dice.below(5)];
  std::uint32_t n = 0;
  while (app.has("t" + std::to_string(n))) ++n;
  auto acts = script(dice, n);
  if (has_events) add_events(app, acts, Dice(seed), n);
  TaskSet& set = app.build();
  Runner runner(set, kind, policy, acts, how);
  EXPECT_TRUE(runner.start());
  runner.run(milliseconds(40));
  Outcome outcome;
  for (const TapRecord& r : runner.records()) outcome.records.push_back(text(r));
  for (const Call& c : app.calls) outcome.calls.push_back(text(c));
  return outcome;
}

TEST(Twins, ExecutiveAndVirtualTimeMakeTheSameSchedule) {
  std::size_t n_records = 0;
  for (std::uint32_t seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const bool has_events = seed % 2 == 0;
    const Outcome executive = run(seed, Kind::kExecutiveOnTwin, {}, has_events);
    const Outcome virtual_time = run(seed, Kind::kVirtual, {}, has_events);
    ASSERT_EQ(executive.records, virtual_time.records);
    ASSERT_EQ(executive.calls, virtual_time.calls);
    n_records += executive.records.size();
  }
  EXPECT_GT(n_records, 8'000u) << "the sets were worth comparing";
}

TEST(Twins, ARunRepeatsToTheLetter) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const Kind kind : {Kind::kVirtual, Kind::kPreemptive}) {
      const Outcome first = run(seed, kind), again = run(seed, kind);
      ASSERT_EQ(first.records, again.records);
      ASSERT_EQ(first.calls, again.calls);
    }
  }
}

std::vector<std::string> with_seed(std::uint64_t seed, Kind kind) {
  Application app;
  for (const char* name : {"a", "b"}) {
    TaskSpec& spec = app.add(name, milliseconds(10));
    spec.min_time = milliseconds(1);
    spec.budget = milliseconds(4);
  }
  VirtualOptions how;
  how.times = seed;
  Runner runner(app.build(), kind, Policy::kEdf, {}, how);
  EXPECT_TRUE(runner.start());
  runner.run(milliseconds(100));
  std::vector<std::string> all;
  for (const TapRecord& r : runner.records()) all.push_back(text(r));
  return all;
}

TEST(Twins, OnlyTheSeedDecidesExecutionTimes) {
  for (const Kind kind : {Kind::kVirtual, Kind::kPreemptive}) {
    EXPECT_EQ(with_seed(1, kind), with_seed(1, kind));
    EXPECT_NE(with_seed(1, kind), with_seed(2, kind));
  }
  // Without a deadline in reach, the order of two equal tasks is the same with and without preemption.
  EXPECT_EQ(with_seed(3, Kind::kVirtual).size(), with_seed(3, Kind::kPreemptive).size());
}

// Preemptive schedules of random sets keep the rules that need no second implementation.
TEST(Twins, APreemptiveProcessorRunsOneJobAtATimeAndMissesNothingUnderLightLoad) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed);
    Application app;
    for (int i = 0; i < 4; ++i) {
      const Nanoseconds spend = microseconds(100 + dice.below(400));
      app.add("t" + std::to_string(i), milliseconds(4 + dice.below(5)), spend);
    }
    Runner runner(app.build(), Kind::kPreemptive, Policy::kEdf);
    ASSERT_TRUE(runner.start());
    runner.run(milliseconds(100));
    Nanoseconds end;
    std::int64_t ran = 0;
    for (const TapRecord& r : runner.records()) {
      ASSERT_NE(r.kind, TapKind::kMiss) << "utilisation is at most a half, so EDF misses nothing";
      if (r.kind != TapKind::kRun) continue;
      ASSERT_GE(r.at, end);
      end = r.at + Nanoseconds{r.b};
      ran += r.b;
    }
    std::int64_t used = 0;
    for (int i = 0; i < 4; ++i) used += app.task("t" + std::to_string(i)).profile.execution[CHIMERA_CYCLE].sum.count;
    EXPECT_LE(ran - used, 500'000) << "all time belongs to cycles, but for one that the end cut";
    EXPECT_GE(ran, used);
  }
}

}  // namespace
}  // namespace chimera::toy::twins_test
