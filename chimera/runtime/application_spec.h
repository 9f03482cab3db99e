// SPDX-License-Identifier: Apache-2.0
// A whole application as handed down to the runtime. Made by Configuration::spec(), or baked into an image. Links are
// ids: verification has resolved every name, and a name in a spec is for messages only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/runtime/safe_condition.h"
#include "chimera/schedule/policy.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// Port number `index` of a task among its ports of one kind: of an out-var also its bit in chimera_slot::valid.
struct PortOf {
  TaskId task;
  std::uint32_t index = 0;
  bool intermittent = false;  ///< PortSpec::intermittent
  constexpr bool operator==(const PortOf&) const noexcept = default;
};

/// A state variable and every port that is linked to it. Several tasks may produce it: at most one of them, or the
/// operator instead of all, in each configuration.
struct Variable {
  std::string_view name;
  std::span<const PortOf> producers;          ///< out-vars, in the order of the tasks
  std::span<const PortOf> consumers;          ///< in-vars, in the order of the tasks
  std::uint32_t operator_index = UINT32_MAX;  ///< in ApplicationSpec::operators; UINT32_MAX: not an operator's

  bool is_given() const noexcept { return operator_index != UINT32_MAX; }
  /// The first producer whose task `is_it(TaskId)` accepts; null: there is none. Context: any; wait-free.
  template <class IsIt>
  const PortOf* producer(IsIt is_it) const noexcept {
    for (const PortOf& each : producers)
      if (is_it(each.task)) return &each;
    return nullptr;
  }
};

/// A constant: its value stands in the description, or tasks produce it at init, one of them in each configuration.
struct ConstantSpec {
  std::string_view name;
  std::uint32_t type = CHIMERA_FLOAT64;
  std::uint32_t element_bytes = 8;
  std::span<const std::byte> value;                ///< given by the description; empty: tasks produce it
  std::uint32_t listed[CHIMERA_MAX_EXTENTS] = {};  ///< of `value`, as PortSpec::listed
  std::span<const PortOf> producers;               ///< out-consts, in the order of the tasks
};

/// The initial value of an operator variable.
struct GivenSpec {
  std::string_view name;  ///< of `variable`
  VariableId variable;
  std::uint32_t type = CHIMERA_FLOAT64;
  std::uint32_t element_bytes = 8;
  ExtentSpec extent[CHIMERA_MAX_EXTENTS];
  std::span<const std::byte> value;  ///< extent[0].max * extent[1].max elements
  std::uint32_t listed[CHIMERA_MAX_EXTENTS] = {};  ///< as PortSpec::listed
};

/// The line between Linux and a board: docs/formats/link.md.
struct LinkSpec {
  std::string_view address;     ///< path of a device, or "HOST:PORT" of UDP; "": the rtpu is no board
  bool is_udp = false;
  std::uint32_t baud = 115200;  ///< of a device
  Nanoseconds period;           ///< between two frames of each direction
  Nanoseconds stale_after;      ///< without a frame for this time values of the other side are not valid
  constexpr bool is_there() const noexcept { return !address.empty(); }
};

/// A real-time processing unit.
struct RtpuSpec {
  std::string_view name;
  std::uint32_t cpu = 0;
  Policy policy = Policy::kEdf;
  bool preemptive = false;  ///< a thread for each task; else one loop, the executive
  LinkSpec link = {};       ///< of a board, whose tasks run there
};

/// The standby takes over the outputs of the primary when that fails. Both have the same outputs.
struct StandbySpec {
  TaskId primary;  ///< not a standby itself
  TaskId standby;  ///< of one primary
  Nanoseconds stale_after{};  ///< above 0: a primary on another rtpu whose outputs are older is killed; kStalePeriods
  bool hot = false;           ///< it cycles while the primary is ON, unread; without resources and out-consts
};

/// The task that `task` is a standby of; `task` itself if it is no standby. Context: any; wait-free.
constexpr TaskId primary_of(std::span<const StandbySpec> standbys, TaskId task) noexcept {
  for (const StandbySpec& each : standbys)
    if (each.standby == task) return each.primary;
  return task;
}

/// A primary that is killed because it is silent may miss at least this many of its periods.
inline constexpr std::int64_t kStalePeriods = 2;

/// Parameters of the reaction `restart` of a task: TaskSpec::on_fault.
struct RestartSpec {
  TaskId task;
  std::uint32_t most = 1;           ///< restarts until the task runs for `within` without a fault; to kMostRestarts
  Nanoseconds within;               ///< above 0
  OnFault then = OnFault::kError;   ///< beyond them, or where it cannot be restarted; `switch` to on_fault_set
};

/// A value that the task reads is invalid for it if it was published longer than `after` ago.
struct StaleSpec {
  TaskId task;
  Nanoseconds after;  ///< above 0
};

/// At most this many restarts are remembered.
inline constexpr std::uint32_t kMostRestarts = 100;

/// A configuration of the description: tasks that may be ON together.
struct NamedSet {
  std::string_view name;
  std::span<const TaskId> order;  ///< each task once, in data-flow order, hardware inputs first
  SafeCondition safe_when{};      ///< must hold while a switch to it arms, and when its instant is proposed
};

struct SwitchPlan;

/// Context: setup. Every span must outlive the runtime that is made from it.
struct ApplicationSpec {
  std::string_view name;
  std::span<const RtpuSpec> rtpus;
  std::span<const TaskSpec> tasks;
  std::span<const Variable> variables;      ///< by VariableId
  std::span<const ConstantSpec> constants;  ///< by ConstantId
  std::span<const GivenSpec> operators;
  std::span<const TaskId> init_order;  ///< every task, producers of constants before their users
  std::span<const TaskId> start;       ///< the tasks that go ON, in data-flow order, hardware inputs first
  std::span<const TaskId> on_order;    ///< every task in the order of going ON; OFF goes backwards: task_orders.h
  std::span<const TaskId> end_order;   ///< every task in the order in which the end turns OFF and kills: task_orders.h
  std::span<const NamedSet> sets;      ///< the configurations, no two of one name; `start` is one where there are any
  std::span<const StandbySpec> standbys;  ///< in the order of the description
  std::span<const RestartSpec> restarts;  ///< one for each task whose reaction on_fault is restart
  std::span<const StaleSpec> stale;       ///< at most one for each task
  /// The plan of the switch from set b to set a at number b * sets.size() + a. Null: plans are made on request.
  const SwitchPlan* plans = nullptr;

  /// Name of what the port is linked to; "" when it is not linked. Context: any; wait-free.
  std::string_view link_name(const PortSpec& port) const noexcept {
    if (port.variable.is_valid()) return variables[port.variable.index].name;
    return port.constant.is_valid() ? constants[port.constant.index].name : std::string_view{};
  }
  /// Port number `of.index` of that kind; null: the task has none. Context: any; wait-free.
  const PortSpec* port(std::uint32_t kind, const PortOf& of) const noexcept {
    std::uint32_t n = 0;
    for (const PortSpec& port : tasks[of.task.index].ports)
      if (port.kind == kind && n++ == of.index) return &port;
    return nullptr;
  }
  /// The two tasks stand in for each other: a primary and its standby, or two standbys of one. Context: any; wait-free.
  bool stand_in(TaskId a, TaskId b) const noexcept {
    return a != b && primary_of(standbys, a) == primary_of(standbys, b);
  }
  /// A port of the task is linked to the constant, or has it for an extent. Context: any; wait-free.
  bool uses(TaskId user, ConstantId constant) const noexcept {
    for (const PortSpec& port : tasks[user.index].ports) {
      if (port.kind == CHIMERA_IN_CONST && port.constant == constant) return true;
      for (const ExtentSpec& extent : port.extent)
        if (extent.constant == constant) return true;
    }
    return false;
  }
  /// Does `user` use a constant that `producer` makes? Context: any; wait-free.
  bool uses_constant_of(TaskId user, TaskId producer) const noexcept {
    for (std::size_t c = 0; c < constants.size(); ++c)
      for (const PortOf& made : constants[c].producers)
        if (made.task == producer && uses(user, ConstantId(c))) return true;
    return false;
  }
};

}  // namespace chimera
