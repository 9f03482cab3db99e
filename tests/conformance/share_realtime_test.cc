// SPDX-License-Identifier: Apache-2.0
// The share of the processor with real-time levels: jobs that wait give way too.
#include <gtest/gtest.h>

#include "tests/conformance/by_threads.h"
#include "tests/conformance/judged.h"

namespace chimera::toy {
namespace {

struct Seen {
  std::uint64_t demoted = 0, begun = 0, slices = 0, wrong_levels = 0;
};

// The important task is promised more than there is, so whoever waits 1 ms for it gives way. In its first cycle it
// makes the other one wait, and ends that job by a signal; later both are brief and never there together.
Seen run_once() {
  Application app;
  TaskSpec& important = app.add("important", milliseconds(10));
  important.criticality = 2;
  important.budget = milliseconds(9);
  TaskSpec& other = app.add("other", milliseconds(20), microseconds(100));
  other.budget = milliseconds(1);
  other.offset = milliseconds(5);
  app.toy("important").during = [n = 0](const chimera_call& call) mutable {
    if (++n == 1) call.host->spend(call.context, milliseconds(8).count);
    return CHIMERA_OK;
  };
  app.toy("important").sends = {{Signal::kOff, "other"}, {Signal::kOn, "other"}};
  ProcessorPlace place = checked_place();
  place.share = milliseconds(60);
  place.window = milliseconds(100);
  const Left left = run_by_threads(app, Policy::kMuf, milliseconds(200), place);
  Seen seen;
  seen.demoted = app.task("other").profile.demoted;
  seen.begun = app.task("other").profile.cycles;
  seen.wrong_levels = left.counts.wrong_levels;
  for (const TapRecord& r : left.records) seen.slices += r.kind == TapKind::kRun && r.task == app.id("other") ? 1u : 0u;
  return seen;
}

TEST(ShareOfLevels, AJobThatGaveWayAndWasTakenBackLeavesTheNextOneAsItIs) {
  if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: nobody waits";
  const auto seen = judged(microseconds(500), run_once);
  if (!seen) GTEST_SKIP() << "not judged: host stalled";
  EXPECT_EQ(seen->demoted, 1u);
  EXPECT_GE(seen->begun, 8u);
  EXPECT_EQ(seen->slices, seen->begun) << "what runs below all others has none";
  EXPECT_EQ(seen->wrong_levels, 0u);
}

}  // namespace
}  // namespace chimera::toy
