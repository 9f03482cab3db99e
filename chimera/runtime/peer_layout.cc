// SPDX-License-Identifier: Apache-2.0
// Plans the groups of a peer's segment: outputs, constants, faults and operator variables.
#include "chimera/runtime/peer_layout.h"

#include "chimera/task/fault_record.h"

namespace chimera {

struct PeerLayout::Storage {
  std::deque<std::vector<VariableSpec>> variables;
  std::vector<GroupSpec> specs;
  std::vector<GroupPlace> groups;
  std::vector<VariablePlace> places;

  void add(std::string_view owner, std::vector<VariableSpec> group) {
    variables.push_back(std::move(group));
    specs.push_back({owner, variables.back()});
  }
};

Result<PeerLayout> PeerLayout::of(const ApplicationSpec& spec, std::uint32_t peer) { return make(spec, false, peer); }

Result<PeerLayout> PeerLayout::of_everything(const ApplicationSpec& spec) { return make(spec, true, 0); }

void PeerLayout::plan_task(const ApplicationSpec& spec, const TaskSpec& task, Storage& storage) {
  std::vector<VariableSpec> outputs, constants;
  for (const PortSpec& port : task.ports) {
    const VariableSpec variable{spec.link_name(port), port.element_bytes, port.max_count()};
    if (port.kind == CHIMERA_OUT_VAR) outputs.push_back(variable);
    if (port.kind == CHIMERA_OUT_CONST) constants.push_back(variable);
  }
  storage.add(task.name, outputs);
  storage.add(task.name, outputs);
  storage.add(task.name, constants);
  storage.add(task.name, {{kFaultVariable, sizeof(FaultRecord), 1}});
}

Result<PeerLayout> PeerLayout::make(const ApplicationSpec& spec, bool everything, std::uint32_t peer) {
  PeerLayout made;
  made.storage_ = std::make_shared<Storage>();
  Storage& storage = *made.storage_;
  made.first_group_.assign(spec.tasks.size(), UINT32_MAX);
  for (std::size_t t = 0; t < spec.tasks.size(); ++t) {
    if (!everything && spec.tasks[t].rtpu.index != peer) continue;
    made.first_group_[t] = static_cast<std::uint32_t>(storage.specs.size());
    plan_task(spec, spec.tasks[t], storage);
  }
  made.first_operator_ = storage.specs.size();
  if (everything || peer == spec.rtpus.size())
    for (const GivenSpec& given : spec.operators)
      storage.add("operator", {{given.name, given.element_bytes, given.extent[0].max * given.extent[1].max}});
  storage.groups.resize(storage.specs.size());
  storage.places.resize(TableLayout::count_variables(storage.specs));
  const auto table = TableLayout::plan(storage.specs, UINT64_MAX, storage.groups, storage.places);
  if (!table) return table.error();
  made.table_ = std::make_shared<const TableLayout>(*table);
  return made;
}

std::span<const VariablePlace> PeerLayout::variables(GroupId group) const noexcept {
  const GroupPlace& at = place(group);
  return table_->variables().subspan(at.first_variable, at.variables);
}

}  // namespace chimera
