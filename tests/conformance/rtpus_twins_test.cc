// SPDX-License-Identifier: Apache-2.0
// In virtual time an rtpu without inputs from others gives the records of a run alone. A run of several rtpus repeats
// to the byte, for all lengths of its pieces and for each order in which contexts are made.
#include <gtest/gtest.h>

#include "tests/conformance/random_toys.h"
#include "tests/conformance/rtpus_run.h"

namespace chimera::toy::rtpus_twins_test {
namespace {

constexpr Policy kPolicies[] = {Policy::kEdf, Policy::kRm, Policy::kMuf, Policy::kMufLaxity, Policy::kLlf};

std::vector<ScriptAct> signals_of(std::vector<ScriptAct> acts) {
  std::erase_if(acts, [](const ScriptAct& act) { return act.kind != ScriptAct::Kind::kSignal; });
  return acts;
}

struct Outcome {
  std::vector<std::string> records, calls;
};

constexpr Nanoseconds kRan = milliseconds(45), kCompared = milliseconds(40);

// Records of the first `n` tasks, without those of the end of the run.
Outcome outcome_of(std::vector<TapRecord> records, const std::vector<Call>& calls, std::uint32_t n, RtpuId rtpu) {
  Outcome outcome;
  for (const TapRecord& r : records)
    if (r.rtpu == rtpu.index && r.at < kCompared) outcome.records.push_back(text(r));
  for (const Call& c : calls)
    if (c.task[0] == 't' && std::stoul(c.task.substr(1)) < n && c.now < kCompared) outcome.calls.push_back(text(c));
  return outcome;
}

// Methods at edges need time in every second run.
void fill_edges(Application& app, std::uint32_t seed) {
  Dice dice(1000 + seed);
  for (std::uint32_t i = 0; seed % 2 == 0 && app.has("t" + std::to_string(i)); ++i)
    app.toy("t" + std::to_string(i)).spend_at_edges = microseconds(dice.below(900));
}

Outcome alone(std::uint32_t seed, bool preemptive, const VirtualOptions& how) {
  Dice dice(seed);
  Application app;
  fill(app, dice);
  fill_edges(app, seed);
  const Policy policy = kPolicies[dice.below(5)];
  std::uint32_t n = 0;
  while (app.has("t" + std::to_string(n))) ++n;
  auto acts = signals_of(script(dice, n));
  if (seed % 4 < 2) add_events(app, acts, Dice(seed), n);
  TaskSet& set = app.build();
  Runner runner(set, preemptive ? Kind::kPreemptive : Kind::kVirtual, policy, acts, how);
  EXPECT_TRUE(runner.start());
  runner.run(kRan);
  return outcome_of(runner.records(), app.calls, n, RtpuId(0u));
}

// These tasks on rtpu `me` of three. The other rtpus, preemptive and not, have tasks that read each other.
Outcome in_company(std::uint32_t seed, bool preemptive, std::uint32_t me, const VirtualOptions& how) {
  Dice dice(seed);
  Application app;
  fill(app, dice);
  fill_edges(app, seed);
  const Policy policy = kPolicies[dice.below(5)];
  std::uint32_t n = 0;
  for (; app.has("t" + std::to_string(n)); ++n) app.spec("t" + std::to_string(n)).rtpu = RtpuId(me);
  auto acts = signals_of(script(dice, n));
  if (seed % 4 < 2) add_events(app, acts, Dice(seed), n);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::string reads = "other" + std::to_string((i + 5) % 6);
    TaskSpec& spec = app.add("other" + std::to_string(i), microseconds(700 + dice.below(3000)),
                             microseconds(50 + dice.below(400)), reads);
    spec.rtpu = RtpuId((me + 1 + i % 2) % 3);
  }
  std::vector<RtpuSpec> rtpus(3, RtpuSpec{"company", 1, Policy::kEdf, dice.below(2) == 0});
  rtpus[me] = {"me", 0, policy, preemptive};
  app.place_on(rtpus);
  RtpusRun run(app.build_rtpus(), acts, how);
  EXPECT_TRUE(run.start());
  run.run(kRan);
  EXPECT_GT(app.task("other5").profile.cycles, 5u);
  return outcome_of(run.records(), app.calls, n, RtpuId(me));
}

TEST(RtpusTwins, AnRtpuWithoutInputsFromOthersRunsAsAlone) {
  std::size_t n_records = 0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed)
    for (const bool preemptive : {false, true}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + (preemptive ? " preemptive" : ""));
      VirtualOptions how;
      if (seed % 3 == 0) how.times = seed;
      const Outcome first = alone(seed, preemptive, how);
      const Outcome second = in_company(seed, preemptive, seed % 3, how);
      ASSERT_EQ(first.records, second.records);
      ASSERT_EQ(first.calls, second.calls);
      n_records += first.records.size();
    }
  EXPECT_GT(n_records, 5'000u) << "the sets were worth comparing";
}

/// Three rtpus whose tasks read each other, send each other signals, and die.
struct Entangled {
  explicit Entangled(std::uint32_t seed, std::vector<std::uint32_t> order = {}) {
    Dice dice(seed);
    fill(app, dice);
    fill_edges(app, seed);
    std::uint32_t n = 0;
    for (; app.has("t" + std::to_string(n)); ++n) app.spec("t" + std::to_string(n)).rtpu = RtpuId(dice.below(3));
    acts = script(dice, n);
    if (seed % 2 == 0) add_events(app, acts, Dice(seed), n);
    ScriptAct death;
    death.at = milliseconds(30);
    death.kind = ScriptAct::Kind::kDie;
    death.rtpu = RtpuId(dice.below(3));
    const auto later = std::find_if(acts.begin(), acts.end(), [&](const auto& act) { return act.at > death.at; });
    acts.insert(later, death);
    std::vector<RtpuSpec> rtpus;
    for (const char* name : {"a", "b", "c"}) rtpus.push_back({name, 0, kPolicies[dice.below(5)], dice.below(2) == 0});
    app.place_on(rtpus);
    run = std::make_unique<RtpusRun>(app.build_rtpus({}, std::move(order)), acts);
    EXPECT_TRUE(run->start());
  }
  std::vector<std::string> result() {
    run->shut_down();
    std::vector<std::string> all;
    for (const TapRecord& r : run->records()) all.push_back(std::to_string(r.rtpu) + " " + text(r));
    for (const Call& c : app.calls) all.push_back(text(c));
    for (const RefusedSignal& r : run->refused()) all.push_back(std::to_string(r.at.count) + signal_name(r.signal));
    return all;
  }

  Application app;
  std::vector<ScriptAct> acts;
  std::unique_ptr<RtpusRun> run;
};

TEST(RtpusTwins, ARunRepeatsForEachOrderOfTheContexts) {
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Entangled first(seed), again(seed), turned(seed, {2, 0, 1});
    for (Entangled* one : {&first, &again, &turned}) one->run->run(milliseconds(40));
    const auto result = first.result();
    ASSERT_EQ(result, again.result());
    ASSERT_EQ(result, turned.result());
    EXPECT_GT(result.size(), 15u);
  }
}

TEST(RtpusTwins, ARunThatIsInterruptedIsTheSameRun) {
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Entangled first(seed), pieces(seed);
    first.run->run(milliseconds(40));
    for (int i = 1; i < 57; ++i) (void)pieces.run->run_to(microseconds(700 * i));
    pieces.run->run(milliseconds(40));
    ASSERT_EQ(first.result(), pieces.result());
  }
}

}  // namespace
}  // namespace chimera::toy::rtpus_twins_test
