// SPDX-License-Identifier: Apache-2.0
// Without real-time levels, and without other threads: the job that has the processor after each change.
#include "chimera/runtime/preemptive/processor.h"

#include <gtest/gtest.h>

#include "chimera/runtime/task_word.h"
#include "chimera/runtime/testing/preemptive_parts.h"

namespace chimera {
namespace {

struct ProcessorTest : testing::PreemptiveParts, ::testing::Test {
  Nanoseconds at(std::int64_t ms) const { return origin + milliseconds(ms); }
  void make_two(ProcessorPlace where = {}) {
    add("fast", milliseconds(10));
    add("slow", milliseconds(20));
    make(Policy::kEdf, where);
  }
  /// The task whose body runs, as another process reads it.
  TaskId shown() { return TaskWord::found(job(0).task.running->load()).task(); }
};

TEST_F(ProcessorTest, ShowsWhichBodyRuns) {
  make_two();
  JobThread& slow = begin(1, at(0));
  processor().show_running();
  EXPECT_EQ(shown(), slow.id);
  JobThread& fast = release(0, at(5));
  EXPECT_EQ(processor().on_processor(), &fast);
  EXPECT_FALSE(shown().is_valid()) << "it has not begun";
  ready().remove(fast);
  processor().dispatch(at(6));
  EXPECT_EQ(shown(), slow.id);
}

TEST_F(ProcessorTest, AJobThatHasNotBegunIsNotPreempted) {
  make_two();
  JobThread& slow = release(1, at(0));
  release(0, at(1));
  EXPECT_EQ(slow.task.profile.preempted, 0u);
  EXPECT_EQ(processor().seen().preemptions, 0u);
}

TEST_F(ProcessorTest, DemotesAJobOnce) {
  make_two();
  JobThread &slow = begin(1, at(0)), &fast = begin(0, at(1));
  processor().demote(fast, at(2));
  processor().demote(fast, at(3));
  EXPECT_TRUE(fast.is_demoted);
  EXPECT_TRUE(fast.phase.is_running()) << "below all others";
  EXPECT_EQ(fast.task.profile.demoted, 1u);
  EXPECT_EQ(fast.task.profile.preempted, 0u) << "that is no preemption";
  EXPECT_EQ(processor().on_processor(), &slow);
  EXPECT_EQ(slow.slice(), at(2)) << "it goes on from here";
}

TEST_F(ProcessorTest, AJobThatIsCancelledLeavesNothingBehind) {
  make_two();
  JobThread& fast = release(0, at(0));
  ASSERT_TRUE(fast.phase.try_claim());
  processor().cancel(fast, at(1));
  EXPECT_EQ(fast.phase.value(), JobPhase::kCancelled);
  EXPECT_EQ(checks().due(fast), kNever);
  EXPECT_FALSE(fast.task.is_busy);
  EXPECT_EQ(ready().size(), 0u);
  EXPECT_EQ(processor().on_processor(), nullptr);
}

TEST_F(ProcessorTest, AJobThatGoesOnIsCheckedWhenItsBudgetEnds) {
  TaskSpec& spec = add("limited", milliseconds(20));
  spec.budget = milliseconds(3);
  spec.on_overrun = OnMiss::kAbort;
  add("fast", milliseconds(10));
  make();
  JobThread& limited = begin(0, at(0));
  JobThread& fast = release(1, at(1));
  checks().clear(limited);
  ready().remove(fast);
  processor().dispatch(at(6));
  EXPECT_GT(checks().due(limited), at(6));
  EXPECT_LE(checks().due(limited), at(9));
}

TEST_F(ProcessorTest, AServerIsCheckedAtTheEndOfItsCapacityWhileItsJobHasTheProcessor) {
  make_served(milliseconds(10), milliseconds(5), origin);
  JobThread& served = begin(0, at(0));
  EXPECT_EQ(processor().on_processor(), &served);
  const Nanoseconds alone = processor().next_server_check(served, at(0));
  EXPECT_GT(alone, at(0));
  EXPECT_LE(alone, at(1)) << "the capacity is 1 ms";
  JobThread& periodic = release(1, at(0));
  EXPECT_EQ(processor().on_processor(), &periodic);
  EXPECT_EQ(processor().next_server_check(served, at(0)), served.sporadic->job().next_change(at(0)))
      << "it uses nothing while another job has the processor";
}

TEST_F(ProcessorTest, AJobHaltedByItsServerIsNotPreempted) {
  make_served(milliseconds(10), milliseconds(5), origin);
  JobThread& served = begin(0, at(0));
  served.sporadic->halt();
  ready().remove(served);
  processor().dispatch(at(1));
  EXPECT_EQ(processor().on_processor(), nullptr);
  EXPECT_EQ(served.task.profile.preempted, 0u);
  served.sporadic->resume();
}

TEST_F(ProcessorTest, QuantaBeginAnEighthBehindTheGrid) {
  ProcessorPlace where;
  where.quantum = microseconds(800);
  make_two(where);
  EXPECT_EQ(processor().next_quantum(at(0) + microseconds(100)), at(0) + microseconds(900));
  EXPECT_EQ(processor().next_quantum(at(0) + microseconds(899)), at(0) + microseconds(900));
  EXPECT_EQ(processor().next_quantum(at(8)), at(8) + microseconds(100));
}

TEST_F(ProcessorTest, AnEdgeIsAskedForAtTheBellThatWasGiven) {
  std::atomic<std::uint32_t> bell{0};
  ProcessorPlace where;
  where.bell = &bell;
  make_two(where);
  const std::uint32_t before = bell;
  processor().edge_bell().ring();
  EXPECT_NE(bell, before);
}

TEST_F(ProcessorTest, WithChecksItCountsEntriesAndFindsNothingWrong) {
  ProcessorPlace where;
  where.checks = true;
  make_two(where);
  release(1, at(0));
  release(0, at(0));
  for (int i = 0; i < 3; ++i) {
    processor().enter();
    processor().leave();
  }
  EXPECT_EQ(processor().seen().checked, 3u);
  EXPECT_EQ(processor().seen().wrong_levels, 0u);
  EXPECT_EQ(processor().seen().section_taken, 0u);
}

}  // namespace
}  // namespace chimera
