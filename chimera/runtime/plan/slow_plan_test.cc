// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/slow_plan.h"

#include <gtest/gtest.h>

#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/plan/switch_way.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::slow_plan_test {
namespace {

struct Tool {  // has as many outputs as its own constant says
  OutConst<double> mass{"mass", "kg"};
  OutConst<std::int32_t> n{"n", "1"};
  Out<double[]> list{"list", "1", "[n<=4]"};
  Out<double> grip{"grip", "1"};
  Resource port{"port"};
  void cycle(Cycle) {}
};

struct Arm {  // a device, which makes another constant of it
  InConst<double> mass{"mass", "kg"};
  In<double> grip{"grip", "1"};
  OutConst<double> load{"load", "kg"};
  Out<double> y{"y", "1"};
  Resource link{"link"};
  void cycle(Cycle) {}
};

struct Law {
  InConst<double> load{"load", "kg"};
  Out<double> u{"u", "1"};
  void cycle(Cycle) {}
};

struct Clock {
  Out<double> t{"t", "1"};
  void cycle(Cycle) {}
};

constexpr TaskId kLight{0u}, kHeavy{1u}, kArm{2u}, kLaw{3u}, kClock{4u};

/// Says of all values that they differ, or that none does.
struct Made final : MadeConstants {
  bool differ(ConstantId, std::uint32_t, std::uint32_t) const noexcept override { return are_others; }
  bool are_others = true;
};

struct SlowPlanTest : ::testing::Test {
  SlowPlanTest() {
    app.add("light", testing::component<Tool>("tool"));
    app.add("heavy", testing::component<Tool>("tool"));
    app.add("arm", testing::component<Arm>("arm"), milliseconds(4));
    app.add("law", testing::component<Law>("law"));
    app.add("clock", testing::component<Clock>("clock"), milliseconds(50));
    for (const TaskId tool : {kLight, kHeavy}) app.extend(tool.index, 2, 4, "n");
    app.make({kLight, kArm, kLaw, kClock}, false);
    app.spec.sets = sets;
    planner.prepare(app.spec, heap);
    slow.prepare(app.spec, heap);
    ways.prepare(app.spec, heap);
  }
  const SwitchPlan& plan(std::uint32_t from, std::uint32_t to) {
    statuses.assign(5, {State::kOff, false});
    for (const TaskId task : sets[from].order) statuses[task.index].state = State::kOn;
    EXPECT_TRUE(planner.plan(to, statuses, made_plan));
    return made_plan;
  }
  std::vector<SlowStep> steps(std::uint32_t from, std::uint32_t to, std::uint8_t because = kSlowForConstants) {
    const auto list = slow.plan(plan(from, to), from, because);
    return {list.begin(), list.end()};
  }
  SwitchWay way(std::uint32_t from, std::uint32_t to, std::uint32_t constants) {
    const SwitchPlan& made_of_them = plan(from, to);
    return ways.judge(made_of_them, statuses, constants, made, gaps);
  }

  const std::vector<TaskId> light{kLight, kArm, kLaw, kClock}, heavy{kHeavy, kArm, kLaw}, bare{kClock},
      other_law{kHeavy, kLaw};
  const NamedSet sets[4] = {{"light", light}, {"heavy", heavy}, {"bare", bare}, {"law", other_law}};
  testing::TestApplication app;
  HeapMemory heap;
  SwitchPlanner planner;
  SlowPlanner slow;
  SwitchWays ways;
  SwitchPlan made_plan;
  std::vector<TaskStatus> statuses;
  Made made;
  struct : NeededGaps {
    Nanoseconds for_on(TaskId) const noexcept override { return all; }
    Nanoseconds all;
  } gaps;
};

TEST_F(SlowPlanTest, ChecksThenOffThenReinitInOrderThenOn) {
  EXPECT_EQ(steps(0, 1), (std::vector<SlowStep>{{SlowAct::kCheck, kArm},
                                                {SlowAct::kCheck, kLaw},
                                                {SlowAct::kOff, kClock},
                                                {SlowAct::kOff, kLight},
                                                {SlowAct::kReinit, kArm},
                                                {SlowAct::kReinit, kLaw},
                                                {SlowAct::kOn, kHeavy}}));
}

TEST_F(SlowPlanTest, AnArrivingTaskIsReinitialisedToo) {
  EXPECT_EQ(steps(2, 1), (std::vector<SlowStep>{{SlowAct::kCheck, kArm},
                                                {SlowAct::kCheck, kLaw},
                                                {SlowAct::kOff, kClock},
                                                {SlowAct::kReinit, kArm},
                                                {SlowAct::kReinit, kLaw},
                                                {SlowAct::kOn, kHeavy},
                                                {SlowAct::kOn, kArm},
                                                {SlowAct::kOn, kLaw}}));
}

// Users of the constants of a tool may be absent, so nothing can be checked before the tool is created.
TEST_F(SlowPlanTest, ToolsWithOneDeviceTakeTurnsWithIt) {
  const std::vector<std::byte> tty = testing::bytes_of("tty0");
  for (const TaskId tool : {kLight, kHeavy}) app.port(tool.index, 4).value = tty;
  SlowPlanner again;
  SwitchPlanner planner_again;
  again.prepare(app.spec, heap);
  const auto list = again.plan(plan(0, 1), 0, kSlowForResource);
  EXPECT_EQ((std::vector<SlowStep>{list.begin(), list.end()}), (std::vector<SlowStep>{{SlowAct::kOff, kClock},
                                                                                    {SlowAct::kOff, kLight},
                                                                                    {SlowAct::kKill, kLight},
                                                                                    {SlowAct::kSpawn, kHeavy},
                                                                                    {SlowAct::kReinit, kArm},
                                                                                    {SlowAct::kReinit, kLaw},
                                                                                    {SlowAct::kOn, kHeavy}}));
  const auto plain = again.plan(plan(0, 1), 0, kSlowForConstants);
  EXPECT_EQ(plain.size(), 7u) << "two checks, two off, two reinit, one on";
  planner_again.prepare(app.spec, heap);
  statuses[kHeavy.index].state = State::kNotCreated;
  EXPECT_TRUE(planner_again.plan(1, statuses, made_plan));
  EXPECT_EQ(planner.plan(1, statuses, made_plan).why, NoSwitch::kNotCreated) << "without rivals it was killed by hand";
  SwitchWays ways_again;
  ways_again.prepare(app.spec, heap);
  const SwitchWay found = ways_again.judge(made_plan, statuses, 0, made, gaps);
  EXPECT_EQ(found.slow, kSlowForResource | kSlowForConstants);
  EXPECT_EQ(found.absent, kHeavy);
  EXPECT_EQ(found.rival, kLight);
}

TEST(SwitchWays, EachTryHasMoreTimeBesideTheLongestJob) {
  EXPECT_EQ(lead_of_try(microseconds(300), 1), microseconds(300));
  EXPECT_EQ(lead_of_try(microseconds(300), 2), microseconds(2700));
  EXPECT_EQ(lead_of_try(microseconds(300), 3), microseconds(19500));
  EXPECT_EQ(lead_of_try(milliseconds(200), 3), milliseconds(264)) << "a job of 200 ms, once, is no reason for seconds";
}

// The law is released every 1 ms: no gap of its loop is longer.
TEST_F(SlowPlanTest, AnOnThatFitsNoGapOfItsLoopIsKnownBefore) {
  made.are_others = false;
  EXPECT_EQ(way(0, 1, 0).slow, 0);
  gaps.all = milliseconds(1);
  EXPECT_EQ(way(0, 1, 0).slow, 0);
  gaps.all = milliseconds(1) + Nanoseconds{1};
  const SwitchWay found = way(0, 1, 0);
  EXPECT_EQ(found.slow, kSlowForGap);
  EXPECT_EQ(found.gapless, kHeavy);
  EXPECT_EQ(found.needed, gaps.all);
  EXPECT_EQ(way(2, 1, 2).slow, 0) << "only the clock is ON, every 50 ms";
}

// Each pair of configurations, with values that differ and that are equal.
TEST_F(SlowPlanTest, IsSlowOnlyIfATaskThatStaysUsesAConstantThatChanges) {
  const auto found = [&](std::uint32_t from, std::uint32_t to) { return way(from, to, from).constant.task; };
  for (std::uint32_t from = 0; from < 4; ++from)
    for (std::uint32_t to = 0; to < 4; ++to) {
      if (from == to) continue;
      // From `law` on arm arrives, initialised with whatever, and makes what law uses, which stays.
      const bool is_slow = (from == 0 && to == 1) || (from == 1 && to == 0) || (from == 3 && to < 2);
      EXPECT_EQ(way(from, to, from).slow, is_slow ? kSlowForConstants : 0) << from << " to " << to;
      EXPECT_EQ(found(from, to).is_valid(), is_slow);
      made.are_others = false;
      EXPECT_EQ(way(from, to, from).slow, 0) << from << " to " << to;
      made.are_others = true;
    }
  EXPECT_EQ(way(0, 1, 0).constant.task, kArm);
  EXPECT_EQ(app.spec.constants[way(0, 1, 0).constant.constant.index].name, "mass");
}

// After `bare` the constants of `light` or of `bare` are in force: arm was initialised with those of the first that
// names it.
TEST_F(SlowPlanTest, TheProducerIsOfTheSetInForceOrOfTheFirstSetOfTheUser) {
  const ConstantId mass{0u};
  EXPECT_EQ(producer_for(app.spec, mass, kArm, 0), 0u);
  EXPECT_EQ(producer_for(app.spec, mass, kArm, 1), 1u);
  EXPECT_EQ(producer_for(app.spec, mass, kArm, 2), 0u);
  EXPECT_EQ(producer_for(app.spec, mass, kHeavy, 0), 1u);
  EXPECT_EQ(producer_for(app.spec, mass, kClock, kNoSet), 0u);
  EXPECT_EQ(set_of_start(app.spec), 0u);
}

TEST_F(SlowPlanTest, TheFlagIsUpForThePeriodOfTheSlowestDeviceThatIsOn) {
  EXPECT_EQ(flag_lead(app.spec, bits_of(light)), milliseconds(4));
  EXPECT_EQ(flag_lead(app.spec, bits_of(bare)), Nanoseconds{});
}

}  // namespace
}  // namespace chimera::slow_plan_test
