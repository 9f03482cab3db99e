// SPDX-License-Identifier: Apache-2.0
// Plans the groups of a peer's segment: outputs, constants, faults and operator variables.
#include "chimera/runtime/state/peer_layout.h"

#include "chimera/task/fault_record.h"

namespace chimera {
namespace {

constexpr std::size_t kGroupsOfTask = 4;  // two of outputs, constants, fault

// The groups in the order of their numbers.
class GroupList {
 public:
  GroupList(std::size_t groups, std::size_t variables, SetupMemory& memory)
      : groups_(memory.take<GroupSpec>(groups)), variables_(memory.take<VariableSpec>(variables)) {}

  std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(n_groups_); }
  std::span<const GroupSpec> groups() const noexcept { return groups_.first(n_groups_); }

  void add(const VariableSpec& variable) noexcept { variables_[n_variables_++] = variable; }
  /// Makes a group of the variables added since the last group.
  void end_group(std::string_view owner) noexcept {
    groups_[n_groups_++] = {owner, variables_.subspan(begun_, n_variables_ - begun_)};
    begun_ = n_variables_;
  }

 private:
  std::span<GroupSpec> groups_;
  std::span<VariableSpec> variables_;
  std::size_t n_groups_ = 0, n_variables_ = 0, begun_ = 0;
};

void add_ports(const ApplicationSpec& spec, const TaskSpec& task, std::uint32_t kind, GroupList& list) noexcept {
  for (const PortSpec& port : task.ports)
    if (port.kind == kind) list.add({spec.link_name(port), port.element_bytes, port.max_count()});
  list.end_group(task.name);
}

void add_task(const ApplicationSpec& spec, const TaskSpec& task, GroupList& list) noexcept {
  add_ports(spec, task, CHIMERA_OUT_VAR, list);
  add_ports(spec, task, CHIMERA_OUT_VAR, list);
  add_ports(spec, task, CHIMERA_OUT_CONST, list);
  list.add({kFaultVariable, sizeof(FaultRecord), 1});
  list.end_group(task.name);
}

}  // namespace

Result<PeerLayout> PeerLayout::of(const ApplicationSpec& spec, std::uint32_t peer, SetupMemory& memory) {
  return make(spec, false, peer, memory);
}

Result<PeerLayout> PeerLayout::of_everything(const ApplicationSpec& spec, SetupMemory& memory) {
  return make(spec, true, 0, memory);
}

Result<PeerLayout> PeerLayout::make(const ApplicationSpec& spec, bool everything, std::uint32_t peer,
                                    SetupMemory& memory) {
  std::size_t ports = 0;
  for (const TaskSpec& task : spec.tasks) ports += 2 * task.ports.size();  // out-vars stand in two groups
  const std::size_t n_tasks = spec.tasks.size(), n_given = spec.operators.size();
  GroupList list(kGroupsOfTask * n_tasks + n_given, ports + n_tasks + n_given, memory);
  PeerLayout made;
  made.first_group_ = memory.take<std::uint32_t>(n_tasks);
  for (std::size_t t = 0; t < n_tasks; ++t) {
    const bool is_there = everything || spec.tasks[t].rtpu.index == peer;
    made.first_group_[t] = is_there ? list.size() : UINT32_MAX;
    if (is_there) add_task(spec, spec.tasks[t], list);
  }
  made.first_operator_ = list.size();
  if (everything || peer == spec.rtpus.size()) {
    for (const GivenSpec& given : spec.operators) {
      list.add({given.name, given.element_bytes, given.extent[0].max * given.extent[1].max});
      list.end_group("operator");
    }
  }
  const std::span<GroupPlace> groups = memory.take<GroupPlace>(list.size());
  const std::span<VariablePlace> places = memory.take<VariablePlace>(TableLayout::count_variables(list.groups()));
  const auto table = TableLayout::plan(list.groups(), UINT64_MAX, groups, places);
  if (!table) return table.error();
  made.table_ = *table;
  return made;
}

std::span<const VariablePlace> PeerLayout::variables(GroupId group) const noexcept {
  const GroupPlace& at = place(group);
  return table_.variables().subspan(at.first_variable, at.variables);
}

}  // namespace chimera
