// SPDX-License-Identifier: Apache-2.0
// What one bad task does to the others under preemptive scheduling: nothing. Each fault beside a run without it.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/conformance/by_threads.h"
#include "tests/conformance/judged.h"

namespace chimera::toy {
namespace {

constexpr Nanoseconds kGap = microseconds(500);  // 10 % of the shortest period
constexpr Nanoseconds kRun = milliseconds(600);

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
  Seen seen;
  seen.counts = run_by_threads(app, policy, kRun).counts;
  for (const char* name : {"a", "b", "c"}) {
    const Profile& p = app.task(name).profile;
    seen.missed += p.missed;
    seen.dropped += p.dropped;
    seen.cycles += p.cycles;
  }
  seen.bad = app.task("bad").profile;
  return seen;
}

class PreemptiveFaults : public ::testing::TestWithParam<Policy> {
 protected:
  void SetUp() override {
    if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  }
  auto judged_beside(const Bad& bad) {
    return judged(kGap, [&] { return run_once(bad, GetParam()); });
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
  const auto seen = judged_beside([](Application& app) {
    app.toy("bad").spend = microseconds(100);
    // What the host takes while a job runs counts as used by it: up to kGap, and 1 ms between two looks of the witness.
    app.spec("bad").budget = milliseconds(2);
  });
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
  const auto seen = judged_beside(loop);
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
  const auto seen = judged_beside(block);
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
  const auto seen = judged_beside(overruns);
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  expect_others_untouched(*seen);
  EXPECT_GT(seen->bad.overrun, seen->bad.cycles / 2);  // two of three on average
  EXPECT_GT(seen->bad.cycles, 40u) << "a job that takes three periods costs its own task two releases";
  EXPECT_LE(seen->bad.cycles + seen->bad.dropped, 120u);
}

INSTANTIATE_TEST_SUITE_P(Under, PreemptiveFaults, ::testing::Values(Policy::kRm, Policy::kEdf, Policy::kMuf), name_of);

TEST(PreemptiveMany, TwoHundredTasksOnOneProcessorMissNothing) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: levels cannot be judged";
  const auto seen = judged(milliseconds(2), [] {
    Application app;
    for (int i = 0; i < 200; ++i) {
      const int period = 40 + i * 160 / 200;
      app.add("t" + std::to_string(i), milliseconds(period), microseconds(period * 3));  // 200 tasks, 60 % in all
    }
    Seen all;
    all.counts = run_by_threads(app, Policy::kEdf, kRun).counts;
    for (int i = 0; i < 200; ++i) {
      all.missed += app.task("t" + std::to_string(i)).profile.missed;
      all.dropped += app.task("t" + std::to_string(i)).profile.dropped;
    }
    return all;
  });
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(seen->missed, 0u);
  EXPECT_EQ(seen->dropped, 0u);
  EXPECT_EQ(seen->counts.wrong_levels, 0u);
  EXPECT_LE(seen->counts.level_changes, seen->counts.jobs * 4) << "changes of the levels of others, a job";
}

}  // namespace
}  // namespace chimera::toy
