// SPDX-License-Identifier: Apache-2.0
// The three failures of time and every reaction to them, over all executors.
#include <gtest/gtest.h>

#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

constexpr int kCycles = 3;  // of a task at 20 ms, of which the second takes too long

class Reactions : public ::testing::TestWithParam<Kind> {
 protected:
  Application app;
  std::unique_ptr<Runner> runner;

  // "a" works 12 ms in its second cycle and 1 ms in the others.
  TaskSpec& add_late_task() {
    TaskSpec& spec = app.add("a", milliseconds(20), milliseconds(1));
    spec.deadline = milliseconds(10);
    return spec;
  }
  RunEnd go(std::int64_t ms = 20 * kCycles + 1, Nanoseconds late = milliseconds(12)) {
    runner = std::make_unique<Runner>(app.build(), GetParam());
    EXPECT_TRUE(runner->start());
    runner->run(milliseconds(19));
    app.toy("a").spend = late;
    const RunEnd end = runner->run(milliseconds(39));
    app.toy("a").spend = milliseconds(1);
    return end == RunEnd::kTime ? runner->run(milliseconds(ms)) : end;
  }
  const Profile& profile() { return app.task("a").profile; }
  // Releases of the cycles in ms.
  std::string releases() {
    std::string text;
    for (const Call& call : app.calls_of("a", Method::kCycle)) text += std::to_string(call.now.count / 1'000'000) + " ";
    return text;
  }
};

INSTANTIATE_TEST_SUITE_P(All, Reactions, ::testing::Values(Kind::kExecutiveOnTwin, Kind::kVirtual, Kind::kPreemptive),
                         [](const auto& one) { return kind_name(one.param); });

TEST_P(Reactions, ContinuePublishesALateResult) {
  add_late_task().on_miss = OnMiss::kContinue;
  go();
  EXPECT_EQ(releases(), "0 20 40 60 ");
  EXPECT_EQ(profile().missed, 1u);
  EXPECT_EQ(profile().cycles, 4u);
  EXPECT_EQ(profile().held, 0u);
}

TEST_P(Reactions, HoldPublishesNoLateResult) {
  add_late_task().on_miss = OnMiss::kHold;
  go(39);
  EXPECT_EQ(releases(), "0 20 ");
  EXPECT_EQ(app.published("a"), 1);
  EXPECT_EQ(profile().held, 1u);
  EXPECT_EQ(profile().missed, 1u);
}

TEST_P(Reactions, SkipPublishesAndDropsTheNextRelease) {
  add_late_task().on_miss = OnMiss::kSkip;
  go();
  EXPECT_EQ(releases(), "0 20 60 ");
  EXPECT_EQ(profile().dropped, 1u);
  EXPECT_EQ(profile().missed, 1u) << "a release skipped on purpose is no missed deadline";
}

TEST_P(Reactions, AbortPublishesNothingAndEndsAtTheDeadlineWherePreemptionCan) {
  add_late_task().on_miss = OnMiss::kAbort;
  go(39);
  EXPECT_EQ(app.published("a"), 1);
  EXPECT_EQ(profile().aborted, 1u);
  EXPECT_EQ(profile().missed, 1u);
  EXPECT_EQ(profile().response.max, GetParam() == Kind::kPreemptive ? milliseconds(10) : milliseconds(12));
}

TEST_P(Reactions, ErrorCallsTheMethodAndPublishesNothing) {
  add_late_task().on_miss = OnMiss::kError;
  app.toy("a").answers[CHIMERA_ERROR] = {CHIMERA_OK};
  go(39);
  EXPECT_EQ(app.calls_of("a", Method::kError).size(), 1u);
  EXPECT_EQ(app.task("a").state, chimera::State::kOn);
  EXPECT_STREQ(app.task("a").faults.last.text, "missed its deadline");
  EXPECT_EQ(profile().cycles, 1u);
}

TEST_P(Reactions, FlagRaisesTheFlagUntilItIsLowered) {
  add_late_task().on_miss = OnMiss::kFlag;
  go();
  std::string seen;
  for (const Call& call : app.calls_of("a", Method::kCycle)) seen += call.illegal ? 'I' : '.';
  EXPECT_EQ(seen, "..II");
}

TEST_P(Reactions, APartialResultIsPublishedPastTheDeadlineToo) {
  add_late_task().on_miss = OnMiss::kAbort;
  app.toy("a").answers[CHIMERA_CYCLE] = {CHIMERA_OK, CHIMERA_PARTIAL};
  go(39);
  EXPECT_EQ(app.published("a"), 2);
  EXPECT_EQ(profile().partial, 1u);
  EXPECT_EQ(profile().aborted, 0u);
  EXPECT_EQ(profile().missed, 1u);
}

TEST_P(Reactions, OneMissInTwoIsToleratedTwoAreNot) {
  TaskSpec& spec = add_late_task();
  spec.on_miss = OnMiss::kHold;
  spec.tolerated_misses = 1;
  spec.tolerated_of = 2;
  runner = std::make_unique<Runner>(app.build(), GetParam());
  ASSERT_TRUE(runner->start());
  std::string held;
  for (const int late : {0, 1, 0, 1, 1, 1, 0, 0, 1}) {
    app.toy("a").spend = milliseconds(late == 1 ? 12 : 1);
    const auto at = static_cast<std::int64_t>(held.size());
    runner->run(milliseconds(20 * at + 19));
    held += profile().held > 0 ? static_cast<char>('0' + profile().held) : '.';
  }
  EXPECT_EQ(held, "....12222");
  EXPECT_EQ(profile().tolerated, 3u);
  EXPECT_EQ(profile().missed, 5u);
}

TEST_P(Reactions, StopEndsTheRun) {
  add_late_task().on_miss = OnMiss::kStop;
  EXPECT_EQ(go(), RunEnd::kTaskStopped);
  EXPECT_EQ(releases(), "0 20 ");
}

TEST_P(Reactions, AnOverrunWithinTheDeadlineHasItsOwnReaction) {
  TaskSpec& spec = add_late_task();
  spec.budget = milliseconds(5);
  spec.on_miss = OnMiss::kStop;
  spec.on_overrun = OnMiss::kHold;
  go(39, milliseconds(7));
  EXPECT_EQ(profile().overrun, 1u);
  EXPECT_EQ(profile().missed, 0u);
  EXPECT_EQ(app.published("a"), 1);
}

TEST_P(Reactions, MissesInARowUpToTheLimitEndInError) {
  TaskSpec& spec = add_late_task();
  spec.max_consecutive = 2;
  app.toy("a").answers[CHIMERA_ERROR] = {CHIMERA_OK};  // cannot save it
  runner = std::make_unique<Runner>(app.build(), GetParam());
  ASSERT_TRUE(runner->start());
  app.toy("a").spend = milliseconds(12);
  runner->run(milliseconds(35));
  EXPECT_EQ(app.task("a").state, chimera::State::kError);
  EXPECT_EQ(releases(), "0 20 ");
  EXPECT_EQ(app.calls_of("a", Method::kError).size(), 1u);
  EXPECT_STREQ(app.task("a").faults.last.text, "missed as many deadlines in a row as max_consecutive allows");
}

TEST_P(Reactions, AMissBetweenGoodCyclesIsForgiven) {
  add_late_task().max_consecutive = 2;
  go();
  EXPECT_EQ(app.task("a").state, chimera::State::kOn);
  EXPECT_EQ(profile().missed_in_a_row, 0u);
}

TEST_P(Reactions, AStarvedTaskLosesPatienceToo) {
  app.add("greedy", milliseconds(10), milliseconds(10)).user_priority = 1;
  app.add("a", milliseconds(10), milliseconds(1)).max_consecutive = 3;
  runner = std::make_unique<Runner>(app.build(), GetParam());
  ASSERT_TRUE(runner->start());
  runner->run(milliseconds(31));
  EXPECT_EQ(app.task("a").state, chimera::State::kError);
  EXPECT_EQ(profile().missed, 3u);
}

// Released together with a job of 8 ms that goes first, "a" starts at 8 with its deadline at 10.
class Minimum : public Reactions {
 protected:
  void start(OnMiss reaction) {
    TaskSpec& first = app.add("first", milliseconds(40), milliseconds(8));
    first.user_priority = 1;
    first.deadline = milliseconds(10);
    TaskSpec& spec = app.add("a", milliseconds(40), milliseconds(1));
    spec.deadline = milliseconds(10);
    spec.min_time = milliseconds(3);
    spec.on_miss = reaction;
    runner = std::make_unique<Runner>(app.build(), GetParam());
    ASSERT_TRUE(runner->start());
    runner->run(milliseconds(39));
  }
};

INSTANTIATE_TEST_SUITE_P(All, Minimum, ::testing::Values(Kind::kExecutiveOnTwin, Kind::kVirtual, Kind::kPreemptive),
                         [](const auto& one) { return kind_name(one.param); });

TEST_P(Minimum, AStartWithoutItsMinimumRunsUnderContinue) {
  start(OnMiss::kContinue);
  EXPECT_EQ(profile().min_refused, 1u);
  EXPECT_EQ(releases(), "0 ");
}

TEST_P(Minimum, RefusedWithHoldDoesNotStart) {
  start(OnMiss::kHold);
  EXPECT_EQ(profile().min_refused, 1u);
  EXPECT_EQ(profile().dropped, 1u);
  EXPECT_EQ(releases(), "");
}

TEST_P(Minimum, RefusedWithErrorCallsTheMethod) {
  start(OnMiss::kError);
  EXPECT_EQ(app.calls_of("a", Method::kError).size(), 1u);
  EXPECT_STREQ(app.task("a").faults.last.text, "its minimum time can no longer be granted");
  EXPECT_EQ(releases(), "");
}

}  // namespace
}  // namespace chimera::toy
