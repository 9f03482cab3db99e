// SPDX-License-Identifier: Apache-2.0
// The share of the processor that jobs have in real time: who gives way when it is used up. Without real-time levels,
// so also under the thread sanitizer; what it is worth with them is shown by tests/processes/preemptive_test.py.
#include <gtest/gtest.h>

#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/toy.h"

namespace chimera::toy {
namespace {

class Share : public ::testing::Test {
 protected:
  TaskSpec& add(const std::string& name, std::int64_t period_ms, std::int64_t spend_ms, std::int64_t budget_ms,
                std::uint32_t criticality = 0) {
    TaskSpec& spec = app_.add(name, milliseconds(period_ms), milliseconds(spend_ms));
    spec.budget = milliseconds(budget_ms);
    spec.criticality = criticality;
    return spec;
  }
  // With `share` of each `window`.
  void run(Policy policy, Nanoseconds share, Nanoseconds window = milliseconds(100)) {
    RunOptions options;
    options.policy = policy;
    ProcessorPlace place;
    place.share = share;
    place.window = window;
    PreemptiveExecutor executor(app_.build_preemptive(), options, place);
    ASSERT_TRUE(executor.start());
    EXPECT_EQ(executor.run(milliseconds(300)), RunEnd::kTime);
  }
  std::uint64_t demoted(const char* task) { return app_.task(task).profile.demoted; }

  Application app_;
};

TEST_F(Share, NobodyGivesWayWhileThereIsSomeLeft) {
  add("important", 10, 1, 2, 2);
  add("other", 20, 1, 2);
  run(Policy::kMuf, milliseconds(1980), seconds(2));  // a stall counts, too
  EXPECT_EQ(demoted("important"), 0u);
  EXPECT_EQ(demoted("other"), 0u);
}

TEST_F(Share, NobodyGivesWayWithoutALimit) {
  add("important", 10, 1, 2, 2);
  add("other", 20, 19, 6);
  run(Policy::kMuf, kNever);
  EXPECT_EQ(demoted("other"), 0u);
}

TEST_F(Share, TheLessCriticalTaskGivesWay) {
  add("important", 10, 1, 2, 2);
  add("other", 20, 18, 6);
  run(Policy::kMuf, milliseconds(60));
  EXPECT_EQ(demoted("important"), 0u);
  EXPECT_GE(demoted("other"), 1u);
}

// Long before the share is used up: the budget of the important one is kept for it, used or not.
TEST_F(Share, LessCriticalTasksHaveWhatTheOthersMayNeed) {
  add("important", 10, 1, 8, 2);
  add("other", 20, 8, 10);
  run(Policy::kMuf, milliseconds(95));
  EXPECT_EQ(demoted("important"), 0u);
  EXPECT_GE(demoted("other"), 1u);
}

TEST_F(Share, UnderRateMonotonicTheLongestPeriodGivesWay) {
  add("fast", 10, 1, 2);
  add("slow", 20, 18, 6);
  run(Policy::kRm, milliseconds(60));
  EXPECT_EQ(demoted("fast"), 0u);
  EXPECT_GE(demoted("slow"), 1u);
}

TEST_F(Share, AmongEqualsWhoeverIsOverItsBudget) {
  add("honest", 50, 1, 2);
  add("liar", 20, 18, 6);
  run(Policy::kEdf, milliseconds(60));
  EXPECT_GE(demoted("liar"), 1u);
}

}  // namespace
}  // namespace chimera::toy
