// SPDX-License-Identifier: Apache-2.0
// The executive on the Linux clock. Counts and order are judged, durations are not; and nothing is judged while the
// host did not let even a thread above everything else run in time (the witness).
#include <gtest/gtest.h>

#include <thread>

#include "chimera/runtime/executive/counter_clock.h"
#include "tests/conformance/judged.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

struct Seen {
  RunEnd end = RunEnd::kStopped;
  std::uint64_t cycles[3] = {}, dropped = 0, missed = 0;
  std::string first_order;
  bool in_order = true;
};

Seen run_once(bool overload) {
  Application app;
  app.add("fast", milliseconds(2), microseconds(100));
  app.add("middle", milliseconds(5), microseconds(200), "fast");
  app.add("slow", milliseconds(10), overload ? milliseconds(15) : microseconds(300), "middle");
  TaskSet& set = app.build();
  app.calls.reserve(10'000);
  CounterClock clock;
  ComputingClock job_clock(clock);
  Executive executive(set, clock, job_clock, {});
  Seen seen;
  std::thread loop([&] {
    pin_here(50);
    if (!executive.start()) return;
    seen.end = executive.run(milliseconds(400));
    executive.shut_down();
  });
  loop.join();
  Nanoseconds last;
  for (const Call& call : app.calls) {
    if (call.method != Method::kCycle) continue;
    if (seen.first_order.size() < 3) seen.first_order += call.task[0];
    seen.in_order = seen.in_order && call.now >= last;  // releases of a set that fits come in order
    last = call.now;
  }
  const char* names[] = {"fast", "middle", "slow"};
  for (int i = 0; i < 3; ++i) {
    const Profile& p = app.task(names[i]).profile;
    seen.cycles[i] = p.cycles;
    seen.dropped += p.dropped;
    seen.missed += p.missed;
  }
  return seen;
}

TEST(ExecutiveRealtime, RunsEveryCycleInOrderAndDropsNone) {
  const auto seen = judged(kGapAllowed, [] { return run_once(false); });
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(seen->end, RunEnd::kTime);
  EXPECT_EQ(seen->first_order, "fms");
  EXPECT_TRUE(seen->in_order);
  EXPECT_EQ(seen->cycles[0], 200u);
  EXPECT_EQ(seen->cycles[1], 80u);
  EXPECT_EQ(seen->cycles[2], 40u);
  EXPECT_EQ(seen->dropped, 0u);
  EXPECT_EQ(seen->missed, 0u);
}

TEST(ExecutiveRealtime, CountsWhatAnOverloadedSetDropsAndNeverBursts) {
  const auto seen = judged(kGapAllowed, [] { return run_once(true); });
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(seen->first_order, "fms");
  EXPECT_LE(seen->cycles[2], 400u / 15 + 1);
  EXPECT_GT(seen->cycles[2], 10u);
  EXPECT_GT(seen->dropped, 100u);
  // Every release of the 400 ms ran or was dropped, but for the one that the end cut off.
  EXPECT_NEAR(static_cast<double>(seen->cycles[0] + seen->cycles[1] + seen->cycles[2] + seen->dropped), 320, 12);
}

}  // namespace
}  // namespace chimera::toy
