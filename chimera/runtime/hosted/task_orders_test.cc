// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/task_orders.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/testing/named_links.h"

namespace chimera {
namespace {

constexpr TaskId kArm{0u}, kPid{1u}, kTraj{2u}, kReserve{3u};

/// arm (hardware, makes ndof) and pid in a loop over q and tau; traj gives ref; pid and reserve both produce tau.
struct TaskOrders : ::testing::Test {
  TaskOrders() {
    add("arm", {{CHIMERA_IN_VAR, "tau"}, {CHIMERA_OUT_VAR, "q"}, {CHIMERA_OUT_CONST, "ndof"}});
    add("pid", {{CHIMERA_IN_VAR, "q"}, {CHIMERA_IN_VAR, "ref"}, {CHIMERA_OUT_VAR, "tau"}, {CHIMERA_IN_CONST, "ndof"}});
    add("traj", {{CHIMERA_OUT_VAR, "ref"}});
    add("reserve", {{CHIMERA_IN_VAR, "q"}, {CHIMERA_OUT_VAR, "tau"}, {CHIMERA_IN_CONST, "ndof"}});
    tasks_[0].is_hardware = true;
  }

  void add(const char* name, std::vector<std::pair<std::uint32_t, const char*>> ports) {
    auto& mine = ports_.emplace_back();
    for (const auto& [kind, variable] : ports) {
      mine.emplace_back().kind = kind;
      links_.link(mine.back(), variable);
    }
    tasks_.emplace_back().name = name;
  }
  const ApplicationSpec& make(const std::vector<TaskId>& start) {
    start_ = start;
    for (std::size_t t = 0; t < tasks_.size(); ++t) tasks_[t].ports = ports_[t];
    spec_.tasks = tasks_;
    spec_.start = start_;
    links_.finish(spec_);
    return spec_;
  }
  std::string names(std::span<const TaskId> tasks) const {
    return join(tasks, " ", [this](TaskId task) { return tasks_[task.index].name; });
  }

  std::vector<std::vector<PortSpec>> ports_;
  std::vector<TaskSpec> tasks_;
  std::vector<TaskId> start_;
  NamedLinks links_;
  ApplicationSpec spec_;
};

TEST_F(TaskOrders, TheStartSetKeepsItsOrder) {
  EXPECT_EQ(names(make({kArm, kTraj, kPid}).on_order), "arm traj pid reserve");
}

TEST_F(TaskOrders, WithoutAStartSetHardwareComesFirstAndProducersBeforeConsumers) {
  EXPECT_EQ(names(make({}).on_order), "arm traj pid reserve");
}

TEST_F(TaskOrders, ProducersOutsideTheStartSetComeBeforeTheirConsumersInIt) {
  EXPECT_EQ(names(make({kArm, kPid}).on_order), "arm traj pid reserve");
}

TEST_F(TaskOrders, TheEndGoesBackwardsWithHardwareLast) {
  EXPECT_EQ(names(make({kArm, kTraj, kPid}).end_order), "reserve pid traj arm");
  tasks_[2].is_hardware = true;
  EXPECT_EQ(names(make({kArm, kTraj, kPid}).end_order), "reserve pid traj arm");
  tasks_[1].is_hardware = true;
  EXPECT_EQ(names(make({kArm, kTraj, kPid}).end_order), "reserve pid traj arm");
  tasks_[2].is_hardware = false;
  EXPECT_EQ(names(make({kArm, kTraj, kPid}).end_order), "reserve traj pid arm");
}

TEST_F(TaskOrders, UsersOfAConstantAreThoseThatReadIt) {
  const ApplicationSpec& spec = make({});
  ASSERT_EQ(spec.constants.size(), 1u);
  EXPECT_EQ(std::vector(spec.constants[0].producers.begin(), spec.constants[0].producers.end()),
            (std::vector<PortOf>{{kArm, 0}}));
  EXPECT_TRUE(spec.uses_constant_of(kPid, kArm));
  EXPECT_TRUE(spec.uses_constant_of(kReserve, kArm));
  EXPECT_FALSE(spec.uses_constant_of(kTraj, kArm));
  EXPECT_FALSE(spec.uses_constant_of(kArm, kPid));
}

TEST_F(TaskOrders, AVariableListsItsPortsInTheOrderOfTheTasks) {
  const ApplicationSpec& spec = make({});
  const Variable& tau = spec.variables[links_.variable("tau").index];
  EXPECT_EQ(std::vector(tau.producers.begin(), tau.producers.end()),
            (std::vector<PortOf>{{kPid, 0}, {kReserve, 0}}));
  const Variable& ref = spec.variables[links_.variable("ref").index];
  EXPECT_EQ(std::vector(ref.consumers.begin(), ref.consumers.end()), (std::vector<PortOf>{{kPid, 1}}));
}

}  // namespace
}  // namespace chimera
