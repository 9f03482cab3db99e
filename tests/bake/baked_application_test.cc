// SPDX-License-Identifier: Apache-2.0
// Compiled with the tables of one application: tests/bake/CMakeLists.txt.
#include <gtest/gtest.h>

#include <deque>
#include <fstream>
#include <vector>

#include "chimera/bake/room.h"
#include "chimera/runtime/executive/baked.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/runtime/testing/spec_equal.h"
#include "chimera/verify/verify.h"
#include "tests/bake/baked_run.h"

namespace chimera::baked_application_test {

TEST(BakedApplication, IsTheApplicationOfTheDescription) {
  const Verdict verdict = verify(read_description_file(BAKED_DESCRIPTION), built_library());
  ASSERT_TRUE(verdict.configuration) << verdict.report.text();
  const ApplicationSpec& described = verdict.configuration->spec();
  ApplicationSpec expected = described;
  std::vector<TaskSpec> tasks(described.tasks.begin(), described.tasks.end());
  std::deque<std::vector<PortSpec>> ports;
  for (TaskSpec& task : tasks) {
    task.budget = task.min_time = {};  // of another machine
    for (PortSpec& port : ports.emplace_back(task.ports.begin(), task.ports.end())) bake::fit(port, described);
    task.ports = ports.back();
  }
  expected.tasks = tasks;
  std::vector<GivenSpec> operators(described.operators.begin(), described.operators.end());
  for (GivenSpec& given : operators) bake::fit(given, described);
  expected.operators = operators;
  std::vector<ConstantSpec> constants(described.constants.begin(), described.constants.end());
  for (std::size_t c = 0; c < constants.size(); ++c) bake::fit(constants[c], ConstantId(c), expected);
  expected.constants = constants;
  EXPECT_EQ(testing::first_difference(baked::kSpec, expected), "");
}

TEST(BakedApplication, HasOneComponentForEachTask) {
  ASSERT_EQ(baked::kComponents.size(), baked::kSpec.tasks.size());
  for (const chimera_component* component : baked::kComponents) EXPECT_NE(component, nullptr);
}

TEST(BakedApplication, HasValuesThatAProcessorCanReadInPlace) {
  for (const TaskSpec& task : baked::kSpec.tasks)
    for (const PortSpec& port : task.ports) {
      const auto address = reinterpret_cast<std::uintptr_t>(port.value.data());
      EXPECT_EQ(address % 8, 0u) << task.name;
    }
}

TEST(BakedApplication, GivesTheDigestOfTheDescription) {
  std::ifstream file(BAKED_DIGEST);
  const std::string expected{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GT(expected.size(), 100u);
  EXPECT_EQ(digest_of(baked::kSpec, baked::kRun.acts, baked::kRun.duration), expected);
}

std::vector<std::uint32_t> numbers(std::span<const TaskId> tasks) {
  std::vector<std::uint32_t> all;
  for (const TaskId task : tasks) all.push_back(task.index);
  return all;
}

TEST(BakedApplication, HasThePlanThatIsMadeWhileRunning) {
  const ApplicationSpec& spec = baked::kSpec;
  const std::size_t n = spec.sets.size();
  ASSERT_EQ(spec.plans != nullptr, n > 1);
  ApplicationSpec without = spec;
  without.plans = nullptr;
  HeapMemory memory;
  SwitchPlanner made, baked;
  made.prepare(without, memory);
  baked.prepare(spec, memory);
  for (std::uint32_t pair = 0; n > 1 && pair < n * n; ++pair) {
    SCOPED_TRACE(pair);
    std::vector<TaskStatus> statuses(spec.tasks.size(), {State::kOff});
    for (const TaskId task : spec.sets[pair / n].order) statuses[task.index].state = State::kOn;
    SwitchPlan expected, found;
    const std::uint32_t after = static_cast<std::uint32_t>(pair % n);
    ASSERT_EQ(baked.plan(after, statuses, found).why, made.plan(after, statuses, expected).why);
    EXPECT_EQ(found.before, expected.before);
    EXPECT_EQ(found.after, expected.after);
    EXPECT_EQ(numbers(found.arriving), numbers(expected.arriving));
    EXPECT_EQ(numbers(found.leaving), numbers(expected.leaving));
    EXPECT_EQ(numbers(found.staying), numbers(expected.staying));
    ASSERT_EQ(found.handovers.size(), expected.handovers.size());
    for (std::size_t h = 0; h < found.handovers.size(); ++h) {
      EXPECT_EQ(found.handovers[h].variable, expected.handovers[h].variable);
      EXPECT_EQ(found.handovers[h].from, expected.handovers[h].from);
      EXPECT_EQ(found.handovers[h].to, expected.handovers[h].to);
    }
    const bool is_baked = !expected.arriving.empty() || !expected.leaving.empty();
    EXPECT_EQ(found.arriving.data() == spec.plans[pair].arriving.data(), is_baked || found.arriving.data() == nullptr);
  }
}

TEST(BakedApplication, MakesAPlanWhenATaskIsInAnotherStateThanTheBakedOneAssumes) {
  const ApplicationSpec& spec = baked::kSpec;
  if (spec.plans == nullptr) {
    EXPECT_LT(spec.sets.size(), 2u) << "without a switch there are no plans";
    return;
  }
  HeapMemory memory;
  SwitchPlanner planner;
  planner.prepare(spec, memory);
  std::vector<TaskStatus> statuses(spec.tasks.size(), {State::kOff});
  for (const TaskId task : spec.sets[0].order) statuses[task.index].state = State::kOn;
  const SwitchPlan& assumed = spec.plans[1];
  ASSERT_FALSE(assumed.arriving.empty());
  statuses[assumed.arriving[0].index].state = State::kError;
  SwitchPlan plan;
  const PlanAnswer answer = planner.plan(1u, statuses, plan);
  EXPECT_EQ(answer.why, NoSwitch::kInError);
  EXPECT_EQ(answer.task, assumed.arriving[0]);
  statuses[assumed.arriving[0].index].state = State::kOff;
  ASSERT_FALSE(assumed.leaving.empty());
  statuses[assumed.leaving[0].index].state = State::kOff;
  ASSERT_TRUE(planner.plan(1u, statuses, plan));
  EXPECT_EQ(plan.before, kNoSet);
  EXPECT_EQ(plan.leaving.size() + 1, assumed.leaving.size());
}

}  // namespace chimera::baked_application_test
