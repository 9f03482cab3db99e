// SPDX-License-Identifier: Apache-2.0
// Servers of the preemptive executor with real-time levels: the textbook examples unit by unit as in virtual time, and
// what a storm of events does to the others: nothing.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/conformance/by_threads.h"
#include "tests/conformance/classic_set.h"
#include "tests/conformance/judged.h"
#include "tests/conformance/server_examples.h"

namespace chimera::toy {
namespace {

struct Outcome {
  std::string timeline;
  Profile served;
  ProcessorCounts counts;
};

// Jobs a little shorter than whole units, in both: capacity is left over, and what ends at an instant ends before it.
std::string by_virtual_time(const Example& example) {
  Application app;
  const std::vector<ScriptAct> acts = add_example(app, example, kUnit, kALittleLess);
  Runner run(app.build(), Kind::kPreemptive, example.policy, acts);
  EXPECT_TRUE(run.start());
  run.run(kUnit * kExampleUnits);
  return timeline(run.records(), {}, kUnit, "ABS", kExampleUnits);
}

class ServedSchedule : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ServedSchedule, IsThatOfVirtualTimeUnitByUnit) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  const Example& example = kExamples[GetParam()];
  const auto once = [&] {
    Application app;
    const std::vector<ScriptAct> acts = add_example(app, example, kUnit, kALittleLess);
    const Left left = run_by_threads(app, example.policy, kUnit * kExampleUnits, checked_place(), acts);
    return Outcome{timeline(left.records, left.origin, kUnit, "ABS", kExampleUnits), app.task("S").profile,
                   left.counts};
  };
  // An order that the executor gets wrong is wrong every time; a unit that the machine delayed is not. A job that ends
  // a little before a release may end a little after it: then the schedule is that of whole units.
  const std::string expected = by_virtual_time(example);
  const auto is_right = [&](const std::string& line) { return line == expected || line == example.timeline; };
  auto got = judged(kGap, once);
  for (int i = 0; i < 2 && got && !is_right(got->timeline); ++i) {
    std::printf("differs: %s instead of %s\n", got->timeline.c_str(), expected.c_str());
    got = judged(kGap, once);
  }
  if (!got) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_TRUE(is_right(got->timeline)) << got->timeline << " instead of " << expected;
  EXPECT_EQ(got->served.cycles, example.requests.size());
  EXPECT_EQ(got->served.events, example.requests.size());
  EXPECT_EQ(got->counts.section_taken, 0u) << "the kernel's order excludes";
  EXPECT_EQ(got->counts.wrong_levels, 0u);
}

INSTANTIATE_TEST_SUITE_P(Of, ServedSchedule, ::testing::Range(std::size_t{0}, std::size(kExamples)));

// Halted in the middle of the job, and let go on.
TEST(ServedJob, LongerThanTheCapacityGoesOnWhenSomeIsBack) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  for (const ServerKind kind : {kDeferrable, kSporadic}) {
    const auto got = judged(kGap, [&] {
      Application app;
      app.add("A", kUnit * 15, milliseconds(1));
      app.add("B", kUnit * 16, milliseconds(1));
      add_served(app, "S", kind, kUnit * 2, kUnit * 5);
      take_in_turn(app.toy("S"), {kUnit * 4 + kHalf});
      const std::vector<ScriptAct> acts = {ring(kUnit * 3, app.id("S"))};
      const Left left = run_by_threads(app, Policy::kEdf, kUnit * 15, checked_place(), acts);
      return Outcome{timeline(left.records, left.origin, kUnit, "--S", 15).substr(3), app.task("S").profile,
                     left.counts};
    });
    if (!got) GTEST_SKIP() << "not judged: host stalled";
    EXPECT_EQ(got->timeline, kind == kDeferrable ? "SSSS...S...." : "SS...SS...S.");
    EXPECT_EQ(got->served.cycles, 1u);
    EXPECT_GE(got->served.exhausted, kind == kDeferrable ? 1u : 2u);
    EXPECT_EQ(got->counts.wrong_levels, 0u);
  }
}

struct Storm {
  std::uint64_t missed = 0, dropped = 0, cycles = 0;
  Profile served;
  ProcessorCounts counts;
};

constexpr Nanoseconds kStorm = milliseconds(400), kCapacity = milliseconds(1), kServerPeriod = milliseconds(8);

// Three tasks at 47 %, and events of 200 us each for a server that ranks above them: eight times its capacity. At worst
// `b` ends 2.6 ms and `c` 6 ms before the deadline: more than the host may keep from them unseen (kGap).
Storm storm(Policy policy, ServerKind kind, bool blows) {
  Application app;
  app.add("a", milliseconds(10), milliseconds(2));
  app.add("b", milliseconds(12), milliseconds(2));
  app.add("c", milliseconds(20), milliseconds(2));
  app.add("sender", milliseconds(3)).criticality = 2;
  add_served(app, "S", kind, kCapacity, kServerPeriod).criticality = 2;
  app.toy("S").spend = microseconds(200);
  if (blows) {
    app.toy("sender").during = [](const chimera_call& call) {
      for (int i = 0; i < 16; ++i) EXPECT_EQ(call.host->signal(call.context, CHIMERA_SIGNAL_WAKEUP, "S"), CHIMERA_OK);
      return CHIMERA_OK;
    };
  }
  Storm seen;
  seen.counts = run_by_threads(app, policy, kStorm).counts;
  for (const char* name : {"a", "b", "c", "sender"}) {
    const Profile& p = app.task(name).profile;
    seen.missed += p.missed;
    seen.dropped += p.dropped;
    seen.cycles += p.cycles;
  }
  seen.served = app.task("S").profile;
  return seen;
}

void expect_nobody_missed(const Storm& seen) {
  EXPECT_EQ(seen.missed, 0u);
  EXPECT_EQ(seen.dropped, 0u);
  EXPECT_EQ(seen.cycles, 40u + 34u + 20u + 134u);
  EXPECT_EQ(seen.counts.section_taken, 0u);
  EXPECT_EQ(seen.counts.wrong_levels, 0u);
}

class ServedStorm : public ::testing::TestWithParam<std::tuple<Policy, ServerKind>> {};

TEST(ServedCalm, IsWithoutMisses) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  const auto got = judged(kGap, [] { return storm(Policy::kEdf, kDeferrable, false); });
  if (!got) GTEST_SKIP() << "not judged: host stalled";
  expect_nobody_missed(*got);
  EXPECT_EQ(got->served.events, 0u);
}

TEST_P(ServedStorm, OfEventsCostsTheOthersNoDeadline) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  const auto [policy, kind] = GetParam();
  const auto got = judged(kGap, [policy = policy, kind = kind] { return storm(policy, kind, true); });
  if (!got) GTEST_SKIP() << "not judged: host stalled";
  expect_nobody_missed(*got);
  EXPECT_EQ(got->served.events, 134u * 16u) << "every one is counted";
  const std::int64_t periods = kStorm / kServerPeriod + 1;
  EXPECT_LE(got->served.execution[CHIMERA_CYCLE].sum, kCapacity * periods);
  EXPECT_GT(got->served.cycles, 2u * static_cast<std::uint64_t>(periods));
}

INSTANTIATE_TEST_SUITE_P(Of, ServedStorm,
                         ::testing::Combine(::testing::Values(Policy::kRm, Policy::kEdf, Policy::kMuf),
                                          ::testing::Values(kDeferrable, kSporadic)));

}  // namespace
}  // namespace chimera::toy
