// SPDX-License-Identifier: Apache-2.0
// What one bad task does to the others under preemptive scheduling: nothing. Each fault beside a run without it.
#include <gtest/gtest.h>
#include <pthread.h>

#include <optional>

#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/toy.h"
#include "tests/conformance/witness.h"

namespace chimera::toy {
namespace {

constexpr int kTries = 5, kCeiling = 49;
constexpr Nanoseconds kRest = milliseconds(500);  // real-time threads are throttled above 0.95 of a second
constexpr Nanoseconds kGap = microseconds(500);   // 10 % of the shortest period
constexpr Nanoseconds kRun = milliseconds(600);

ProcessorPlace place() {
  ProcessorPlace made;
  made.cpu = static_cast<int>(std::max(1u, std::thread::hardware_concurrency())) - 1;
  made.ceiling = kCeiling;
  made.base = 30;
  made.checks = true;
  return made;
}

/// What was seen of the three good tasks, and of the bad one.
struct Seen {
  std::uint64_t missed = 0, dropped = 0, cycles = 0;
  Profile bad;
  ProcessorCounts counts;
};

using Bad = std::function<void(Application&)>;

// Three tasks at 62 % and one more, more urgent than they are, made bad by `bad`.
Seen run_once(const Bad& bad, Policy policy) {
  Application app;
  app.add("a", milliseconds(6), microseconds(1500));
  app.add("b", milliseconds(10), microseconds(2500));
  app.add("c", milliseconds(20), milliseconds(2));
  TaskSpec& spec = app.add("bad", milliseconds(5));
  spec.budget = microseconds(500);
  spec.on_overrun = OnMiss::kDemote;
  spec.criticality = 2;
  bad(app);
  TaskSet& set = app.build_preemptive();
  RunOptions options;
  options.policy = policy;
  Seen seen;
  PreemptiveExecutor executor(set, options, place());
  std::thread edges([&] {
    (void)enter_realtime({kCeiling, place().cpu, false});
    if (!executor.start()) return;
    executor.run(kRun);
  });
  edges.join();
  for (const char* name : {"a", "b", "c"}) {
    const Profile& p = app.task(name).profile;
    seen.missed += p.missed;
    seen.dropped += p.dropped;
    seen.cycles += p.cycles;
  }
  seen.bad = app.task("bad").profile;
  seen.counts = executor.counts();
  return seen;
}

std::optional<Seen> judged(const Bad& bad, Policy policy = Policy::kMuf) {
  Nanoseconds worst;
  for (int i = 0; i < kTries; ++i) {
    LinuxClock().wait_until(LinuxClock().now() + kRest);
    Witness witness;
    const Seen seen = run_once(bad, policy);
    worst = witness.worst();
    if (worst <= kGap) return seen;
    std::printf("try %d: the witness was %lld us late\n", i + 1, static_cast<long long>(worst.count / 1000));
  }
  std::printf("not judged: host stalled %lld us\n", static_cast<long long>(worst.count / 1000));
  return std::nullopt;
}

class PreemptiveFaults : public testing::TestWithParam<Policy> {
 protected:
  void SetUp() override {
    if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  }
  void expect_others_untouched(const Seen& seen) {
    EXPECT_EQ(seen.missed, 0u);
    EXPECT_EQ(seen.dropped, 0u);
    EXPECT_EQ(seen.cycles, 100u + 60u + 30u);
    EXPECT_EQ(seen.counts.section_taken, 0u);
    EXPECT_EQ(seen.counts.wrong_levels, 0u);
  }
};

TEST_P(PreemptiveFaults, WithoutAFaultNobodyMisses) {
  const auto seen = judged([](Application& app) { app.toy("bad").spend = microseconds(100); }, GetParam());
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  expect_others_untouched(*seen);
  EXPECT_EQ(seen->bad.demoted, 0u);
  EXPECT_EQ(seen->bad.missed, 0u);
}

// An endless loop: it lasts until the run is over.
TEST_P(PreemptiveFaults, AnEndlessLoopIsDemotedOnce) {
  const auto loop = [](Application& app) {
    app.toy("bad").during = [n = 0](const chimera_call& call) mutable {
      const Nanoseconds end = Nanoseconds{call.now_ns} + kRun;
      if (++n == 20)
        while (LinuxClock().now() < end) {
        }
      return CHIMERA_OK;
    };
  };
  const auto seen = judged(loop, GetParam());
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  expect_others_untouched(*seen);
  EXPECT_EQ(seen->bad.demoted, 1u);
  EXPECT_EQ(seen->bad.overrun, 1u);
}

TEST_P(PreemptiveFaults, AJobThatBlocksTwoMillisecondsHoldsNothing) {
  const auto block = [](Application& app) {
    app.toy("bad").during = [](const chimera_call&) {
      LinuxClock clock;
      clock.wait_until(clock.now() + milliseconds(2));
      return CHIMERA_OK;
    };
  };
  const auto seen = judged(block, GetParam());
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  expect_others_untouched(*seen);
  EXPECT_EQ(seen->bad.missed, 0u);
  EXPECT_EQ(seen->bad.demoted, 0u) << "execution time is judged, not elapsed time";
}

TEST_P(PreemptiveFaults, RandomOverrunsNeverMakeABurst) {
  const auto overruns = [](Application& app) {
    app.toy("bad").during = [n = 0u](const chimera_call& call) mutable {
      n = n * 1664525u + 1013904223u;
      call.host->spend(call.context, static_cast<std::int64_t>(n >> 8) % 1'500'000);  // 0 to 300 % of the budget
      return CHIMERA_OK;
    };
  };
  const auto seen = judged(overruns, GetParam());
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  expect_others_untouched(*seen);
  EXPECT_GT(seen->bad.overrun, 60u);
  EXPECT_LE(seen->bad.cycles + seen->bad.dropped, 120u);
}

std::string name_of(const testing::TestParamInfo<Policy>& one) {
  const char* const names[] = {"Rm", "Edf", "Llf", "Muf", "MufLaxity"};
  return names[static_cast<int>(one.param)];
}

INSTANTIATE_TEST_SUITE_P(Under, PreemptiveFaults, testing::Values(Policy::kRm, Policy::kEdf, Policy::kMuf), name_of);

TEST(PreemptiveMany, TwoHundredTasksOnOneProcessorMissNothing) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  for (int tries = 0; tries < kTries; ++tries) {
    Application app;
    for (int i = 0; i < 200; ++i) {
      const int period = 40 + i * 160 / 200;
      app.add("t" + std::to_string(i), milliseconds(period), microseconds(period * 3));  // 200 tasks, 60 % in all
    }
    TaskSet& set = app.build_preemptive();
    LinuxClock().wait_until(LinuxClock().now() + kRest);
    Witness witness;
    PreemptiveExecutor executor(set, {}, place());
    std::thread edges([&] {
      (void)enter_realtime({kCeiling, place().cpu, false});
      if (executor.start()) executor.run(kRun);
    });
    edges.join();
    if (witness.worst() > milliseconds(2)) continue;
    std::uint64_t missed = 0, dropped = 0;
    for (int i = 0; i < 200; ++i) {
      missed += app.task("t" + std::to_string(i)).profile.missed;
      dropped += app.task("t" + std::to_string(i)).profile.dropped;
    }
    const ProcessorCounts counts = executor.counts();
    EXPECT_EQ(missed, 0u);
    EXPECT_EQ(dropped, 0u);
    EXPECT_EQ(counts.wrong_levels, 0u);
    EXPECT_LE(counts.level_changes, counts.jobs * 4) << "changes of the levels of others, a job";
    return;
  }
  GTEST_SKIP() << "not judged: host stalled";
}

}  // namespace
}  // namespace chimera::toy
