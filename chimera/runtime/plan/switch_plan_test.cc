// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/switch_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::switch_plan_test {
namespace {

using testing::component;
using testing::TestApplication;

// A controller makes u and needs a measurement y; the other controller makes z beside it.
struct Plant {
  In<double> u{"u", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle) {}
};
struct Controller {
  In<double> y{"y", "1"};
  Out<double> u{"u", "1", initial = 0.0};
  void cycle(Cycle) {}
};
struct Observer {
  In<double> y{"y", "1"};
  Out<double> z{"z", "1", initial = 0.0};
  void cycle(Cycle) {}
};
struct Using {
  In<double> z{"z", "1"};
  Out<double> u{"u", "1", initial = 0.0};
  void cycle(Cycle) {}
};

constexpr TaskId kPlant{0u}, kOne{1u}, kObserver{2u}, kTwo{3u};

struct Planned {
  Planned() {
    app.add("plant", component<Plant>("plant"));
    app.add("one", component<Controller>("controller"));
    app.add("observer", component<Observer>("observer"));
    app.add("two", component<Using>("using"));
    app.make({kPlant, kOne}, false);
    app.spec.sets = sets;
    planner.prepare(app.spec, heap);
    turn_on({kPlant, kOne});
  }
  void turn_on(const std::vector<TaskId>& on) {
    for (TaskStatus& each : statuses) each.state = State::kOff;
    for (const TaskId id : on) statuses[id.index].state = State::kOn;
  }
  PlanAnswer make(const TaskBits& target) { return planner.plan(target, statuses, plan); }
  PlanAnswer make(std::uint32_t target) { return planner.plan(target, statuses, plan); }
  VariableId variable(std::string_view name) const {
    std::size_t v = 0;
    while (app.spec.variables[v].name != name) ++v;
    return VariableId(v);
  }

  TestApplication app;
  std::vector<TaskId> first{kPlant, kOne}, second{kPlant, kObserver, kTwo}, bare{};
  NamedSet sets[3] = {{"first", first}, {"second", second}, {"none", bare}};
  HeapMemory heap;
  SwitchPlanner planner;
  std::vector<TaskStatus> statuses = std::vector<TaskStatus>(4);
  SwitchPlan plan;
};

std::vector<TaskId> listed(std::span<const TaskId> ids) { return {ids.begin(), ids.end()}; }

TEST(SwitchPlan, ListsArrivingLeavingAndStayingTasksByDataFlow) {
  Planned p;
  ASSERT_TRUE(p.make(1));
  EXPECT_EQ(p.plan.before, 0u);
  EXPECT_EQ(p.plan.after, 1u);
  EXPECT_EQ(listed(p.plan.arriving), (std::vector<TaskId>{kObserver, kTwo}));
  EXPECT_EQ(listed(p.plan.leaving), (std::vector<TaskId>{kOne}));
  EXPECT_EQ(listed(p.plan.staying), (std::vector<TaskId>{kPlant}));
  p.turn_on({kPlant, kObserver, kTwo});
  ASSERT_TRUE(p.make(0));
  EXPECT_EQ(listed(p.plan.leaving), (std::vector<TaskId>{kTwo, kObserver}));  // the reader before its producer
}

TEST(SwitchPlan, NamesEveryVariableThatGetsAnotherProducer) {
  Planned p;
  ASSERT_TRUE(p.make(1));
  ASSERT_EQ(p.plan.handovers.size(), 2u);  // y keeps its own
  const auto of = [&](const char* name) {
    return *std::ranges::find(p.plan.handovers, p.variable(name), &Handover::variable);
  };
  EXPECT_EQ(of("u").from, (PortOf{kOne, 0}));
  EXPECT_EQ(of("u").to, (PortOf{kTwo, 0}));
  EXPECT_FALSE(of("z").from.task.is_valid());
  EXPECT_EQ(of("z").to, (PortOf{kObserver, 0}));
}

TEST(SwitchPlan, ATaskWithoutASuccessorHandsNothingOver) {
  Planned p;
  p.turn_on({kPlant, kObserver, kTwo});
  ASSERT_TRUE(p.make(2));
  EXPECT_TRUE(p.plan.handovers.empty());
  EXPECT_TRUE(p.plan.arriving.empty());
  EXPECT_EQ(p.plan.leaving.size(), 3u);
}

TEST(SwitchPlan, AnOnSetThatIsNoConfigurationIsLeftAsWell) {
  Planned p;
  p.turn_on({kOne});
  ASSERT_TRUE(p.make(1));
  EXPECT_EQ(p.plan.before, kNoSet);
  EXPECT_EQ(p.plan.arriving.size(), 3u);
}

TEST(SwitchPlan, ARefusedPlanNamesTheTask) {
  Planned p;
  EXPECT_EQ(p.make(3).why, NoSwitch::kUnknownSet);
  EXPECT_EQ(p.make(0).why, NoSwitch::kNothingToDo);
  p.statuses[kTwo.index].state = State::kError;
  EXPECT_EQ(p.make(1).why, NoSwitch::kInError);
  EXPECT_EQ(p.make(1).task, kTwo);
  p.statuses[kObserver.index].state = State::kNotCreated;
  EXPECT_EQ(p.make(1).why, NoSwitch::kNotCreated);
  EXPECT_EQ(p.make(1).task, kObserver);
  p.statuses[kObserver.index] = {State::kOff, true};
  EXPECT_EQ(p.make(1).why, NoSwitch::kNotCreated);
  p.statuses[kOne.index].state = State::kOn;
  EXPECT_EQ(p.make(2).why, NoSwitch::kNone);  // ERROR outside the target does not matter
  EXPECT_EQ(p.plan.number, 0u);
}

TEST(SwitchPlan, IsProposedShortBeforeTheChangeButLongerThanAJobTakes) {
  const TaskId fast[] = {TaskId(0u)}, slow[] = {TaskId(1u)}, by_events[] = {TaskId(2u)};
  TaskSpec tasks[3];
  tasks[0].period = microseconds(400);
  tasks[1].period = milliseconds(20);
  tasks[2].aperiodic = true;
  SwitchPlan plan;
  EXPECT_EQ(lead_of(plan, tasks, {}), milliseconds(1));
  plan.arriving = slow;
  plan.leaving = by_events;
  EXPECT_EQ(lead_of(plan, tasks, {}), milliseconds(1));
  plan.leaving = fast;
  EXPECT_EQ(lead_of(plan, tasks, {}), microseconds(300));
  EXPECT_EQ(lead_of(plan, tasks, microseconds(100)), microseconds(300));
  EXPECT_EQ(lead_of(plan, tasks, microseconds(250)), microseconds(450));
  EXPECT_EQ(lead_of(plan, tasks, milliseconds(3)), microseconds(3200));
}

// Any states and any target: the plan, carried out, makes exactly the target; every reader has one producer.
TEST(SwitchPlan, AnyPlanCarriedOutMakesTheTarget) {
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    Planned p;
    for (TaskStatus& each : p.statuses) each.state = static_cast<State>(random() % kStates);
    const auto target = static_cast<std::uint32_t>(random() % 3);
    const std::vector<TaskStatus> before = p.statuses;
    const PlanAnswer answer = p.make(target);
    if (!answer) {
      EXPECT_NE(answer.why, NoSwitch::kUnknownSet);
      continue;
    }
    for (const TaskId id : p.plan.leaving) p.statuses[id.index].state = State::kOff;
    for (const TaskId id : p.plan.arriving) p.statuses[id.index].state = State::kOn;
    for (const TaskId id : p.plan.staying) EXPECT_EQ(before[id.index].state, State::kOn);
    ASSERT_EQ(p.planner.set_in_force(p.statuses), target) << i;
    EXPECT_EQ(p.make(target).why, NoSwitch::kNothingToDo);
  }
}

TEST(SwitchPlan, AStandbyThatIsOnCountsAsItsPrimaryUnlessTheTasksAreExactlyAnotherSet) {
  Planned p;
  const StandbySpec standby[] = {{kOne, kTwo}};
  p.app.spec.standbys = standby;
  EXPECT_EQ(p.planner.set_in_force(p.statuses), 0u);
  p.turn_on({kPlant, kTwo});
  EXPECT_EQ(p.planner.set_in_force(p.statuses), 0u) << "first with two for one";
  ASSERT_TRUE(p.make(0)) << "and yet there is something to do: a person brings the primary back";
  EXPECT_EQ(p.plan.before, 0u);
  EXPECT_EQ(listed(p.plan.arriving), std::vector<TaskId>{kOne});
  EXPECT_EQ(listed(p.plan.leaving), std::vector<TaskId>{kTwo});
  p.turn_on({kPlant, kObserver, kTwo});
  EXPECT_EQ(p.planner.set_in_force(p.statuses), 1u);
  p.turn_on({kTwo});
  EXPECT_EQ(p.planner.set_in_force(p.statuses), kNoSet);
  p.turn_on({kPlant, kOne, kTwo});
  EXPECT_EQ(p.planner.set_in_force(p.statuses), kNoSet) << "one more than there are";
  const TaskId exact[] = {kPlant, kTwo};
  const NamedSet sets[] = {{"first", p.first}, {"exactly", exact}};
  p.app.spec.sets = sets;
  p.turn_on({kPlant, kTwo});
  EXPECT_EQ(p.planner.set_in_force(p.statuses), 1u);
}

TEST(SwitchPlanner, PlansForAnySetOfTasks) {
  Planned planned;
  TaskBits target;
  for (const TaskId id : {kPlant, kOne, kObserver}) target.add(id);
  ASSERT_TRUE(planned.make(target));
  EXPECT_EQ(planned.plan.before, 0u);
  EXPECT_EQ(planned.plan.after, kNoSet);
  ASSERT_EQ(planned.plan.arriving.size(), 1u);
  EXPECT_EQ(planned.plan.arriving[0], kObserver);
  EXPECT_TRUE(planned.plan.leaving.empty());
  EXPECT_EQ(planned.plan.staying.size(), 2u);
  EXPECT_EQ(planned.make(tasks_of(planned.app.spec, 0)).why, NoSwitch::kNothingToDo);
}

TEST(SwitchPlanner, ThePlanForTheTasksOfASetIsThePlanOfTheSet) {
  Planned planned;
  ASSERT_TRUE(planned.make(1u));
  const std::vector<TaskId> arriving(planned.plan.arriving.begin(), planned.plan.arriving.end());
  ASSERT_TRUE(planned.make(tasks_of(planned.app.spec, 1)));
  EXPECT_EQ(planned.plan.after, 1u);
  EXPECT_TRUE(std::ranges::equal(planned.plan.arriving, arriving));
}

}  // namespace
}  // namespace chimera::switch_plan_test
