// SPDX-License-Identifier: Apache-2.0
// The executive on the virtual twin of its clock and non-preemptive virtual time must make the same schedule, record
// by record; and every run of virtual time must repeat to the byte.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_()) % n; }

 private:
  std::mt19937 engine_;
};

// Anything that a description may say, overload included.
void fill(Application& app, Dice& dice) {
  constexpr OnMiss kReactions[] = {OnMiss::kContinue, OnMiss::kHold, OnMiss::kSkip, OnMiss::kAbort,
                                   OnMiss::kError,    OnMiss::kFlag};
  const std::uint32_t n = 1 + dice.below(8);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::string name = "t" + std::to_string(i);
    const std::string reads = i > 0 && dice.below(2) == 0 ? "t" + std::to_string(dice.below(i)) : "";
    TaskSpec& spec = app.add(name, milliseconds(1 + dice.below(9)), microseconds(50 + dice.below(900)), reads);
    spec.offset = milliseconds(dice.below(3));
    if (dice.below(3) == 0) spec.deadline = microseconds(500);
    spec.criticality = dice.below(3);
    spec.user_priority = dice.below(3);
    spec.budget = microseconds(300 + dice.below(700));
    spec.on_miss = kReactions[dice.below(6)];
    spec.on_overrun = kReactions[dice.below(6)];
    if (dice.below(4) == 0) spec.min_time = microseconds(200);
    if (dice.below(4) == 0) spec.max_consecutive = 1 + dice.below(4);
    spec.aperiodic = dice.below(4) == 0;
    for (std::uint32_t k = 0; k < 20; ++k) {
      app.toy(name).answers[CHIMERA_SYNC].push_back(dice.below(2) == 0 ? CHIMERA_OK : CHIMERA_NO_EVENT);
      app.toy(name).answers[CHIMERA_ERROR].push_back(dice.below(2) == 0 ? CHIMERA_OK : CHIMERA_FAULT);
      const auto signal = dice.below(2) == 0 ? Signal::kOff : Signal::kOn;
      app.toy(name).sends.emplace_back(signal, dice.below(4) == 0 ? "t" + std::to_string(dice.below(i + 1)) : "");
    }
  }
}

std::vector<ScriptAct> script(Dice& dice, std::uint32_t n) {
  std::vector<ScriptAct> acts;
  Nanoseconds at;
  for (int i = 0; i < 12; ++i) {
    at += microseconds(dice.below(6000));
    const std::uint32_t what = dice.below(6);
    constexpr Signal kSignals[] = {Signal::kOn, Signal::kOff, Signal::kClear, Signal::kReinit};
    if (what < 4) acts.push_back({at, ScriptAct::Kind::kSignal, kSignals[what], TaskId(dice.below(n))});
    else acts.push_back({at, what == 4 ? ScriptAct::Kind::kRaiseFlag : ScriptAct::Kind::kLowerFlag, {}, TaskId()});
  }
  return acts;
}

std::string text(const TapRecord& r) {
  return "kind " + std::to_string(static_cast<int>(r.kind)) + " task " + std::to_string(r.task.index) + " at " +
         std::to_string(r.at.count) + " a " + std::to_string(r.a) + " b " + std::to_string(r.b);
}

struct Outcome {
  std::vector<std::string> records;
  std::vector<std::string> calls;
};

Outcome run(std::uint32_t seed, Kind kind, const VirtualOptions& how = {}) {
  Dice dice(seed);
  Application app;
  fill(app, dice);
  constexpr Policy kPolicies[] = {Policy::kEdf, Policy::kRm, Policy::kMuf, Policy::kMufLaxity, Policy::kLlf};
  const Policy policy = kPolicies[dice.below(5)];
  TaskSet& set = app.build();
  const auto acts = script(dice, static_cast<std::uint32_t>(set.tasks().size()));
  Runner runner(set, kind, policy, acts, how);
  EXPECT_TRUE(runner.start());
  runner.run(milliseconds(40));
  Outcome outcome;
  for (const TapRecord& r : runner.records()) outcome.records.push_back(text(r));
  for (const Call& c : app.calls) {
    outcome.calls.push_back(c.task + " " + method_name(c.method) + " " + std::to_string(c.now.count) + " " +
                            std::to_string(c.in) + " " + std::to_string(c.dropped) + " " + std::to_string(c.inherited) +
                            (c.illegal ? " illegal" : ""));
  }
  return outcome;
}

TEST(Twins, ExecutiveAndVirtualTimeMakeTheSameSchedule) {
  std::size_t n_records = 0;
  for (std::uint32_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Outcome executive = run(seed, Kind::kExecutiveOnTwin);
    const Outcome virtual_time = run(seed, Kind::kVirtual);
    ASSERT_EQ(executive.records, virtual_time.records);
    ASSERT_EQ(executive.calls, virtual_time.calls);
    n_records += executive.records.size();
  }
  EXPECT_GT(n_records, 10'000u) << "the sets were worth comparing";
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
  how.seed = seed;
  Runner runner(app.build(), kind, Policy::kEdf, {}, how);
  EXPECT_TRUE(runner.start());
  runner.run(milliseconds(100));
  std::vector<std::string> all;
  for (const TapRecord& r : runner.records()) all.push_back(text(r));
  return all;
}

TEST(Twins, TheSeedDecidesExecutionTimesAndNothingElseDoes) {
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
    EXPECT_LE(ran - used, 500'000) << "all of it belongs to cycles, but for one that the end cut";
    EXPECT_GE(ran, used);
  }
}

}  // namespace
}  // namespace chimera::toy
