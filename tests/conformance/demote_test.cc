// SPDX-License-Identifier: Apache-2.0
// Jobs that go on below all others, in preemptive virtual time, to the instant.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/conformance/runner.h"

#include "chimera/base/hosted/wording.h"

namespace chimera::toy {
namespace {

class Demote : public ::testing::Test {
 protected:
  Application app;
  std::unique_ptr<Runner> runner;

  TaskSpec& add_bad(std::int64_t period_ms, std::int64_t spend_ms, std::int64_t budget_ms) {
    TaskSpec& spec = app.add("bad", milliseconds(period_ms), milliseconds(spend_ms));
    spec.criticality = 2;
    spec.budget = milliseconds(budget_ms);
    return spec;
  }
  void run(std::int64_t ms) {
    runner = std::make_unique<Runner>(app.build(), Kind::kPreemptive, Policy::kMuf);
    ASSERT_TRUE(runner->start());
    runner->run(milliseconds(ms));
  }
  /// Tasks that had the processor, with times in ms: "bad 0-2, a 2-5".
  std::string slices() {
    std::string text;
    for (const TapRecord& r : runner->records()) {
      if (r.kind != TapKind::kRun) continue;
      const std::int64_t from = r.at.count / 1'000'000;
      append_joined(text, ", ", (r.task == app.id("bad") ? "bad " : "a ") + std::to_string(from) + "-" +
                                    std::to_string(from + r.b / 1'000'000));
    }
    return text;
  }
  std::int64_t overruns_recorded() {
    const auto records = runner->records();
    return std::count_if(records.begin(), records.end(), [](const auto& r) { return r.kind == TapKind::kOverrun; });
  }
  const Profile& profile(const char* name = "bad") { return app.task(name).profile; }
};

TEST_F(Demote, AfterItsBudgetAJobRunsInIdleTime) {
  add_bad(40, 6, 2).on_overrun = OnMiss::kDemote;
  app.add("a", milliseconds(10), milliseconds(5));
  run(40);
  EXPECT_EQ(slices(), "bad 0-2, a 2-7, bad 7-10, a 10-15, bad 15-16, a 20-25, a 30-35");
  EXPECT_EQ(profile().demoted, 1u);
  EXPECT_EQ(profile().overrun, 1u);
  EXPECT_EQ(profile().cycles, 1u);
  EXPECT_EQ(profile().preempted, 0u) << "a demoted job gives way uncounted";
  EXPECT_EQ(profile().execution[CHIMERA_CYCLE].max, milliseconds(6));
  EXPECT_EQ(profile("a").missed, 0u);
}

TEST_F(Demote, AJobThatEndsWithItsBudgetIsNotDemoted) {
  add_bad(10, 2, 2).on_overrun = OnMiss::kDemote;
  run(40);
  EXPECT_EQ(profile().demoted, 0u);
  EXPECT_EQ(profile().overrun, 0u);
  EXPECT_EQ(profile().cycles, 4u);
}

TEST_F(Demote, AnOverrunIsRecordedOnceWhenItHappens) {
  add_bad(40, 6, 2).on_overrun = OnMiss::kDemote;
  run(80);
  EXPECT_EQ(profile().overrun, 2u);
  EXPECT_EQ(overruns_recorded(), 2);
}

TEST_F(Demote, AfterItsDeadlineAJobRunsInIdleTime) {
  TaskSpec& spec = add_bad(40, 6, 0);
  spec.deadline = milliseconds(3);
  spec.on_miss = OnMiss::kDemote;
  app.add("a", milliseconds(10), milliseconds(5));
  run(40);
  EXPECT_EQ(slices(), "bad 0-3, a 3-8, bad 8-10, a 10-15, bad 15-16, a 20-25, a 30-35");
  EXPECT_EQ(profile().demoted, 1u);
  EXPECT_EQ(profile().missed, 1u);
}

TEST_F(Demote, AJobThatWaitsPreemptedIsDemotedAtItsDeadlineToo) {
  TaskSpec& spec = add_bad(40, 3, 0);
  spec.criticality = 0;
  spec.deadline = milliseconds(12);
  spec.on_miss = OnMiss::kDemote;
  TaskSpec& urgent = app.add("a", milliseconds(10), milliseconds(8));
  urgent.criticality = 1;
  run(40);
  EXPECT_EQ(slices(), "a 0-8, bad 8-10, a 10-18, bad 18-19, a 20-28, a 30-38");
  EXPECT_EQ(profile().preempted, 1u);
  EXPECT_EQ(profile().demoted, 1u);
}

TEST_F(Demote, ReleasesDuringADemotedJobWaitForItsEnd) {
  add_bad(10, 12, 2).on_overrun = OnMiss::kDemote;
  run(40);
  EXPECT_EQ(slices(), "bad 0-2, bad 2-12, bad 12-14, bad 14-24, bad 24-26, bad 26-36, bad 36-38, bad 38-40");
  EXPECT_EQ(profile().demoted, 4u);
  EXPECT_EQ(profile().cycles, 3u);
}

TEST_F(Demote, TheFirstDemotedJobContinuesToItsEnd) {
  add_bad(40, 6, 1).on_overrun = OnMiss::kDemote;
  TaskSpec& spec = app.add("a", milliseconds(40), milliseconds(4));
  spec.budget = milliseconds(2);
  spec.on_overrun = OnMiss::kDemote;
  run(40);
  EXPECT_EQ(slices(), "bad 0-1, a 1-3, bad 3-8, a 8-10");
}

TEST(Preempted, IsCountedOnceForEachTimeTheProcessorWasTaken) {
  Application app;
  app.add("low", milliseconds(40), milliseconds(12));
  app.add("high", milliseconds(5), milliseconds(1));
  Runner runner(app.build(), Kind::kPreemptive, Policy::kRm);
  ASSERT_TRUE(runner.start());
  runner.run(milliseconds(40));
  EXPECT_EQ(app.task("low").profile.preempted, 2u);  // 1-5, 6-10, 11-15
  EXPECT_EQ(app.task("high").profile.preempted, 0u);
  std::uint64_t told = 0;
  for (const TapRecord& r : runner.records()) told += r.kind == TapKind::kPreempt ? 1u : 0u;
  EXPECT_EQ(told, 2u);
}

}  // namespace
}  // namespace chimera::toy
