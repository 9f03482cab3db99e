// SPDX-License-Identifier: Apache-2.0
// How soon a job that is not over at its deadline is told: within 1 ms, whether it loops, waits in a system call or
// never got the processor, alone and beside others.
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

#include "tests/conformance/by_threads.h"
#include "tests/conformance/judged.h"
#include "tests/conformance/listener.h"

namespace chimera::toy {
namespace {

constexpr Nanoseconds kSoon = milliseconds(1);
constexpr Nanoseconds kRun = milliseconds(100);
constexpr int kBadCycle = 3;

struct Seen {
  Nanoseconds deadline;  // of the bad job
  std::vector<Listener::Miss> misses;
  TaskId bad;
  std::uint64_t wrong_levels = 0;

  Listener::Miss first() const { return misses.empty() ? Listener::Miss{} : misses[0]; }
  Nanoseconds delay() const { return misses.empty() ? kNever : misses[0].told - deadline; }
};

Seen run(Application& app, const char* bad, const Nanoseconds& deadline) {
  std::atomic<std::uint32_t> bell{0};
  Listener listener(bell);
  RunOptions options;
  options.policy = Policy::kMuf;
  options.guest = &listener;
  ProcessorPlace place = checked_place();
  place.bell = &bell;
  Seen seen;
  {
    PreemptiveExecutor executor(app.build_preemptive(), options, place);
    at_the_ceiling([&] {
      if (executor.start()) executor.run(kRun);
    });
    seen.wrong_levels = executor.counts().wrong_levels;
  }
  seen.deadline = deadline;
  seen.bad = app.id(bad);
  seen.misses = listener.of(seen.bad);
  return seen;
}

// What takes 20 ms of a job that has 5. It is released long after another one has ended: then the alarm stands as late
// as it ever does.
void computes() {
  LinuxClock clock;
  for (const Nanoseconds end = clock.now() + milliseconds(20); clock.now() < end;) {
  }
}
void waits() {
  LinuxClock clock;
  (void)clock.wait_until(clock.now() + milliseconds(20));
}

Seen run_bad(void (*takes_long)(), int n_others) {
  Application app;
  app.add("bad", milliseconds(25)).deadline = milliseconds(5);
  for (int i = 0; i < n_others; ++i) app.add("other" + std::to_string(i), milliseconds(3 + i), microseconds(300));
  Nanoseconds deadline;
  app.toy("bad").during = [&deadline, takes_long, n = 0](const chimera_call& call) mutable {
    if (++n != kBadCycle) return CHIMERA_OK;
    deadline = Nanoseconds{call.deadline_ns};
    takes_long();
    return CHIMERA_OK;
  };
  return run(app, "bad", deadline);
}

class LateSoon : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: nothing is soon";
  }
  static void expect_soon(const Seen& seen) {
    EXPECT_GE(seen.delay(), Nanoseconds{});
    EXPECT_LE(seen.delay(), kSoon) << "seen " << seen.delay().count / 1000 << " us after the deadline";
    EXPECT_EQ(seen.wrong_levels, 0u);
  }
  // A job that is alone may be seen 0.6 ms late without anybody's doing.
  static Nanoseconds gap() { return GetParam() == 0 ? microseconds(200) : microseconds(700); }
};

INSTANTIATE_TEST_SUITE_P(Beside, LateSoon, ::testing::Values(0, 3),
                         [](const auto& one) { return one.param == 0 ? std::string("Nobody") : "Others"; });

TEST_P(LateSoon, AJobThatComputes) {
  const auto seen = judged(gap(), [] { return run_bad(computes, GetParam()); });
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  expect_soon(*seen);
  EXPECT_EQ(seen->first().culprit, seen->bad);
  EXPECT_FALSE(seen->first().is_blocked);
}

TEST_P(LateSoon, AJobThatWaitsInASystemCall) {
  const auto seen = judged(gap(), [] { return run_bad(waits, GetParam()); });
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  expect_soon(*seen);
  EXPECT_EQ(seen->first().culprit, seen->bad);
  EXPECT_TRUE(seen->first().is_blocked);
}

// Its deadline is before its next release; whoever has the processor keeps to its own.
TEST_P(LateSoon, AJobThatNeverGotTheProcessor) {
  const auto starve = [] {
    Application app;
    app.add("starves", milliseconds(50)).deadline = milliseconds(2);
    TaskSpec& spec = app.add("long", milliseconds(100), milliseconds(4));
    spec.criticality = 2;
    spec.budget = milliseconds(5);
    for (int i = 0; i < GetParam(); ++i) app.add("other" + std::to_string(i), milliseconds(30 + i));
    Nanoseconds deadline;
    app.toy("long").during = [&deadline, n = 0](const chimera_call& call) mutable {
      if (n++ == 0) deadline = Nanoseconds{call.now_ns} + milliseconds(2);
      return CHIMERA_OK;
    };
    return run(app, "starves", deadline);
  };
  const auto seen = judged(gap(), starve);
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  expect_soon(*seen);
}

}  // namespace
}  // namespace chimera::toy
