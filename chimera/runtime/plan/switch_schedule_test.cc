// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/switch_schedule.h"

#include <gtest/gtest.h>

#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera::switch_schedule_test {
namespace {

TaskSpec task(std::int64_t period_ms, std::int64_t budget_ms, std::uint32_t rtpu = 0, std::int64_t offset_ms = 0) {
  TaskSpec made;
  made.name = "t";
  made.period = made.deadline = milliseconds(period_ms);
  made.budget = milliseconds(budget_ms);
  made.offset = milliseconds(offset_ms);
  made.rtpu = RtpuId(rtpu);
  return made;
}

/// Each set is a list of tasks, of an application on CPUs 1, 2 and again 1.
struct Scene {
  Scene(std::vector<TaskSpec> with, std::vector<std::vector<TaskId>> configurations)
      : tasks(std::move(with)), orders(std::move(configurations)), statuses(tasks.size()) {
    for (const auto& order : orders) sets.push_back({"s", order});
    spec.tasks = tasks;
    spec.rtpus = rtpus;
    spec.sets = sets;
    schedule.prepare(spec, heap);
  }
  PlanAnswer judge(std::uint32_t before, std::uint32_t after) {
    for (TaskStatus& each : statuses) each.state = State::kOff;
    for (const TaskId id : orders[before]) statuses[id.index].state = State::kOn;
    return schedule.judge(statuses, tasks_of(spec, after));
  }

  std::vector<TaskSpec> tasks;
  std::vector<std::vector<TaskId>> orders;
  std::vector<NamedSet> sets;
  RtpuSpec rtpus[3] = {{"a", 1, Policy::kEdf, true}, {"b", 2, Policy::kEdf, true}, {"c", 1, Policy::kEdf, true}};
  ApplicationSpec spec;
  HeapMemory heap;
  SwitchSchedule schedule;
  std::vector<TaskStatus> statuses;
};

constexpr TaskId kA{0u}, kB{1u}, kC{2u};

TEST(SwitchSchedule, AllowsLikeForLikeAndForbidsTasksThatMeet) {
  Scene scene({task(10, 8), task(10, 7), task(10, 8, 0, 9)}, {{kA}, {kB}, {kC}});
  EXPECT_TRUE(scene.judge(0, 1));
  EXPECT_TRUE(scene.judge(1, 0));
  const PlanAnswer answer = scene.judge(0, 2);
  EXPECT_EQ(answer.why, NoSwitch::kNotSchedulable);
  EXPECT_EQ(answer.task, kA);
  EXPECT_FALSE(scene.judge(2, 0));
}

TEST(SwitchSchedule, CountsTasksOfAllRtpusOnTheCpuAndNoOthers) {
  EXPECT_TRUE(Scene({task(10, 8), task(10, 8, 1, 9)}, {{kA}, {kB}}).judge(0, 1));
  EXPECT_FALSE(Scene({task(10, 8), task(10, 8, 2, 9)}, {{kA}, {kB}}).judge(0, 1));
}

TEST(SwitchSchedule, ATaskThatMayMissDoesNotForbidASwitch) {
  Scene scene({task(10, 8), task(10, 8, 0, 9)}, {{kA}, {kB}});
  for (TaskSpec& each : scene.tasks) each.on_miss = OnMiss::kAbort;
  EXPECT_TRUE(scene.judge(0, 1));
  scene.tasks[1].on_miss = OnMiss::kContinue;
  EXPECT_EQ(scene.judge(0, 1).task, kB);
  scene.tasks[1].tolerated_misses = 1;
  scene.tasks[1].tolerated_of = 10;
  EXPECT_TRUE(scene.judge(0, 1));
}

TEST(SwitchSchedule, AllowsASwitchOutOfAnOverload) {
  Scene scene({task(10, 8), task(10, 8), task(10, 8, 0, 9)}, {{kA, kB}, {kC}, {kA}});
  EXPECT_TRUE(scene.judge(0, 1));   // out of an overload
  EXPECT_FALSE(scene.judge(2, 0));  // into it
  EXPECT_EQ(scene.judge(2, 0).takes, kNever);
}

TEST(SwitchSchedule, AHotStandbyCountsBesideItsPrimaryAndAfterIt) {
  Scene scene({task(10, 4), task(10, 5), task(10, 5)}, {{kA}, {kA, kB}, {kC}});
  EXPECT_TRUE(scene.judge(0, 1));
  std::vector<StandbySpec> pair{{kA, kC, {}, true}};
  scene.spec.standbys = pair;
  EXPECT_EQ(scene.judge(0, 1).why, NoSwitch::kNotSchedulable) << "it goes on cycling beside both";
  EXPECT_TRUE(scene.judge(0, 2)) << "it cycles before and after";
  pair[0].hot = false;
  EXPECT_TRUE(scene.judge(0, 1));
}

TEST(SwitchSchedule, ReportsTheTasksThatItConsideredOnACpu) {
  Scene scene({task(10, 4), task(10, 0), task(20, 2, 1)}, {{kA, kC}, {kB, kC}});
  scene.statuses[0].state = scene.statuses[2].state = State::kOn;
  scene.schedule.consider(scene.statuses, tasks_of(scene.spec, 1));
  const CpuTransition moved = scene.schedule.on_cpu_of(RtpuId(0u));
  EXPECT_TRUE(moved.is_moved);
  EXPECT_EQ(moved.cpu, 1u);
  EXPECT_EQ(moved.guarantee, Guarantee::kNotStated);
  EXPECT_EQ(moved.task, kB);
  EXPECT_EQ(moved.settled, kNever);
  const CpuTransition other = scene.schedule.on_cpu_of(RtpuId(1u));
  EXPECT_FALSE(other.is_moved);
  EXPECT_EQ(other.guarantee, Guarantee::kYes);
  EXPECT_TRUE(scene.schedule.is_first_of_cpu(RtpuId(0u)));
  EXPECT_FALSE(scene.schedule.is_first_of_cpu(RtpuId(2u)));
}

}  // namespace
}  // namespace chimera::switch_schedule_test
