// SPDX-License-Identifier: Apache-2.0
#include "firmware/watch/vitals.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "firmware/watch/watchdog.h"

namespace chimera::firmware::vitals_test {
namespace {

/// Tasks 0 and 1 with periods of 10 ms and 4 ms; task 2 is aperiodic, at most every 5 ms. All are ON.
class VitalsTest : public ::testing::Test {
 protected:
  VitalsTest() {
    const Nanoseconds periods[3] = {milliseconds(10), milliseconds(4), milliseconds(5)};
    for (std::size_t t = 0; t < 3; ++t) {
      specs[t].period = periods[t];
      specs[t].aperiodic = t == 2;
      tasks[t].id = TaskId(t);
      tasks[t].spec = &specs[t];
      tasks[t].state = State::kOn;
    }
    paint(main);
    paint(handler);
  }
  /// Looks once a millisecond up to `ms`; tasks in `live` complete a cycle before each look.
  VitalAnswer go_on(int ms, std::initializer_list<std::size_t> live) {
    VitalAnswer answer;
    for (int i = 0; i < ms; ++i) {
      for (const std::size_t t : live) ++tasks[t].profile.cycles;
      answer = vitals.look(now = now + milliseconds(1));
      if (!answer.is_healthy()) break;
    }
    return answer;
  }
  static void expect(const VitalAnswer& answer, VitalFault fault, TaskId task) {
    EXPECT_EQ(answer.fault, fault) << vital_word(answer.fault);
    EXPECT_EQ(answer.task, task);
  }

  std::array<TaskSpec, 3> specs{};
  std::array<Task, 3> tasks{};
  std::array<std::uint32_t, 16> main{}, handler{};
  std::array<Stack, 2> stacks{Stack{"main", main}, Stack{"handler", handler}};
  HeapMemory heap;
  Vitals vitals{tasks, stacks, heap};
  Nanoseconds now;
};

TEST_F(VitalsTest, TasksThatCycleAreHealthy) {
  EXPECT_TRUE(go_on(100, {0, 1}).is_healthy());
}

TEST_F(VitalsTest, TaskIsSilentAfterTwoPeriodsWithoutACycle) {
  go_on(50, {0, 1});
  EXPECT_TRUE(go_on(8, {0}).is_healthy()) << "two periods of 4 ms";
  expect(go_on(1, {0}), VitalFault::kSilent, TaskId(1u));
  EXPECT_EQ(now, milliseconds(59));
}

TEST_F(VitalsTest, OneCycleInTwoPeriodsIsEnough) {
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(go_on(1, {0, 1}).is_healthy());
    ASSERT_TRUE(go_on(7, {0}).is_healthy());
  }
}

TEST_F(VitalsTest, TwoPeriodsBeginWhenATaskGoesOn) {
  tasks[0].state = State::kOff;
  go_on(1000, {1});
  tasks[0].state = State::kOn;
  EXPECT_TRUE(go_on(20, {1}).is_healthy());
  expect(go_on(1, {1}), VitalFault::kSilent, TaskId(0u));
}

TEST_F(VitalsTest, TasksThatAreNotOnOweNothing) {
  for (const State state : {State::kOff, State::kNotCreated, State::kError}) {
    tasks[0].state = state;
    EXPECT_TRUE(go_on(100, {1}).is_healthy()) << state_name(state);
  }
}

TEST_F(VitalsTest, AperiodicTaskWithoutEventsOwesNothing) {
  EXPECT_TRUE(go_on(1000, {0, 1}).is_healthy());
}

TEST_F(VitalsTest, EventOfAnAperiodicTaskMayWaitForTwoPeriods) {
  go_on(50, {0, 1});
  tasks[2].events = 1;
  EXPECT_TRUE(go_on(10, {0, 1}).is_healthy());
  expect(go_on(1, {0, 1}), VitalFault::kUnheard, TaskId(2u));
}

TEST_F(VitalsTest, AnsweredEventsLeaveTimeForTheNext) {
  tasks[2].events = 100;  // a backlog that is worked off
  EXPECT_TRUE(go_on(100, {0, 1, 2}).is_healthy());
}

TEST_F(VitalsTest, ErrorCountsForHighCriticalityOnly) {
  tasks[1].state = State::kError;
  for (const std::uint32_t criticality : {0u, 1u}) {
    specs[1].criticality = criticality;
    EXPECT_TRUE(go_on(3, {0}).is_healthy());
  }
  specs[1].criticality = kHighCriticality;
  expect(go_on(1, {0}), VitalFault::kCritical, TaskId(1u));
  tasks[1].state = State::kOff;
  EXPECT_TRUE(go_on(3, {0}).is_healthy());
}

TEST_F(VitalsTest, OverwrittenGuardNamesItsStack) {
  handler[0] = 0;
  const VitalAnswer answer = go_on(1, {0, 1});
  EXPECT_EQ(answer.fault, VitalFault::kGuard);
  EXPECT_EQ(answer.stack, 1u);
}

class WatchdogTest : public VitalsTest, public WatchdogPort {
 protected:
  void stroke() noexcept override { ++strokes; }

  int strokes = 0;
  ResetRecord record;
};

TEST_F(WatchdogTest, StrokesWhileHealthyAndKeepsTheReasonWhenNot) {
  (void)take_up(record);
  Watchdog watchdog(vitals, *this, record);
  for (int ms = 0; ms < 8; ++ms) watchdog.tick(milliseconds(ms));
  EXPECT_EQ(strokes, 8);
  for (int ms = 8; ms < 20; ++ms) watchdog.tick(milliseconds(ms));
  EXPECT_EQ(strokes, 9) << "two periods of task 1 are over after 8 ms";
  EXPECT_EQ(watchdog.last().fault, VitalFault::kSilent);
  ResetRecord after_reset = record;
  const Boot boot = take_up(after_reset);
  EXPECT_EQ(boot.vital, VitalFault::kSilent);
  EXPECT_EQ(boot.vital_number, 1u);
  ++tasks[0].profile.cycles;
  ++tasks[1].profile.cycles;
  watchdog.tick(milliseconds(20));
  EXPECT_EQ(strokes, 10);
  EXPECT_EQ(take_up(record).vital, VitalFault::kNone);
}

TEST_F(WatchdogTest, HealthyRunEndsTheRowOfWarmBoots) {
  for (int boot = 0; boot < 3; ++boot) (void)take_up(record);
  Watchdog watchdog(vitals, *this, record);
  for (Task& task : tasks) task.state = State::kNotCreated;
  watchdog.tick({});
  watchdog.tick(Watchdog::kSettled - Nanoseconds{1});
  ResetRecord early = record;
  EXPECT_EQ(take_up(early).warm_boots, 3u);
  watchdog.tick(Watchdog::kSettled);
  EXPECT_EQ(take_up(record).warm_boots, 1u);
}

}  // namespace
}  // namespace chimera::firmware::vitals_test
