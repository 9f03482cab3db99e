// SPDX-License-Identifier: Apache-2.0
// A verified model as the plain specs of the runtime: every value as bytes, every name a view into Parts.
#include <cstring>

#include "chimera/base/assert.h"
#include "chimera/verify/parts.h"
#include "chimera/verify/values.h"

namespace chimera {
namespace {

using Parts = Configuration::Parts;

std::string_view keep(Parts& parts, std::string text) { return parts.texts.emplace_back(std::move(text)); }

std::span<const std::byte> keep(Parts& parts, std::vector<std::byte> bytes) {
  return parts.values.emplace_back(std::move(bytes));
}

void fill_extents(Parts& parts, const LinkedPort& port, ExtentSpec (&out)[CHIMERA_MAX_EXTENTS]) {
  for (std::size_t i = 0; i < port.extents.size(); ++i) {
    out[i].max = port.extents[i].max;
    if (!port.extents[i].constant.empty()) out[i].constant = keep(parts, port.extents[i].constant);
  }
}

/// A value that check_values has accepted.
std::vector<std::byte> accepted(Model& model, const Node& node, const LinkedPort& port) {
  auto bytes = value_bytes(model, node, {port, {}});
  CHIMERA_ASSERT(bytes.has_value());
  return std::move(*bytes);
}

void count_list(const Node& node, std::uint32_t (&listed)[CHIMERA_MAX_EXTENTS]) {
  const Node* at = &node;
  for (std::uint32_t& entries : listed) {
    if (!at->is_list() || at->items.empty()) return;
    entries = static_cast<std::uint32_t>(at->items.size());
    at = &at->items[0];
  }
}

std::span<const std::byte> value_of(Model& model, Parts& parts, const LinkedPort& port) {
  if (port.is(CHIMERA_RESOURCE)) {
    std::vector<std::byte> bytes(port.own->text.size());
    std::memcpy(bytes.data(), port.own->text.data(), bytes.size());
    return keep(parts, std::move(bytes));
  }
  if (port.own != nullptr) return keep(parts, accepted(model, *port.own, port));
  if (port.is(CHIMERA_OUT_VAR) || port.source == ConstSource::kDefault) return keep(parts, declared_bytes(port));
  return {};
}

PortSpec port_spec(Model& model, Parts& parts, const LinkedPort& port, const ConfiguredPort& configured) {
  PortSpec spec;
  spec.declared = port.index;
  spec.kind = port.declared->kind;
  spec.instance = port.instance;
  spec.variable = configured.variable;
  if (!port.is(CHIMERA_RESOURCE)) {
    spec.unit = configured.unit;
    spec.element_bytes = port.element_bytes;
    spec.type = *port.type;
    fill_extents(parts, port, spec.extent);
  } else {
    spec.type = CHIMERA_STRING;
    spec.element_bytes = 0;
  }
  spec.safety = port.declared->safety;
  spec.has_range = port.declared->has_range;
  spec.min = port.declared->min;
  spec.max = port.declared->max;
  spec.value = value_of(model, parts, port);
  if (port.own != nullptr) count_list(*port.own, spec.listed);
  return spec;
}

TaskSpec task_spec(const TaskModel& task, const ConfiguredTask& configured, std::span<const PortSpec> ports) {
  TaskSpec spec;
  spec.name = configured.name;
  spec.component = configured.component;
  spec.period = *task.period;
  spec.offset = task.offset;
  spec.deadline = task.deadline;
  spec.budget = task.budget;
  spec.min_time = task.min_time;
  spec.criticality = task.criticality;
  const DraftTask& draft = *task.draft;
  spec.user_priority = draft.user_priority ? draft.user_priority->value : 0;
  spec.max_consecutive = draft.max_consecutive ? draft.max_consecutive->value : 0;
  if (draft.on_miss) spec.on_miss = draft.on_miss->kind;
  if (draft.on_overrun) spec.on_overrun = draft.on_overrun->kind;
  if (draft.tolerate) spec.tolerated_misses = draft.tolerate->misses;
  if (draft.tolerate) spec.tolerated_of = draft.tolerate->of;
  if (draft.stack_bytes) spec.stack_bytes = static_cast<std::uint32_t>(draft.stack_bytes->value);
  spec.aperiodic = configured.is_aperiodic;
  spec.is_hardware = configured.is_hardware;
  spec.rtpu = RtpuId(task.rtpu);
  spec.ports = ports;
  if (draft.server) {
    spec.server = ServerSpec{draft.server->kind, draft.server->capacity.value, draft.server->period.value};
    spec.period = spec.deadline = spec.server->period;
    spec.offset = {};
  }
  return spec;
}

void add_given(Model& model, Parts& parts, const VariableModel& variable, const ConfiguredVariable& configured) {
  if (variable.given == nullptr || variable.consumers.empty()) return;
  const LinkedPort& port = model.port(variable.consumers[0]);
  GivenSpec spec;
  spec.name = configured.name;
  spec.type = *port.type;
  spec.element_bytes = port.element_bytes;
  fill_extents(parts, port, spec.extent);
  spec.value = keep(parts, accepted(model, variable.given->value, port));
  count_list(variable.given->value, spec.listed);
  (variable.is_constant ? parts.constants : parts.operators).push_back(spec);
}

}  // namespace

void fill_spec(Model& model, Parts& parts) {
  for (const DraftRtpu& rtpu : model.rtpus)
    parts.rtpus.push_back({keep(parts, rtpu.name.text), rtpu.cpu.value, rtpu.policy.value, rtpu.preemptive.value});
  parts.ports.resize(model.tasks.size());
  for (std::size_t t = 0; t < model.tasks.size(); ++t) {
    const TaskModel& task = model.tasks[t];
    for (std::size_t p = 0; p < task.ports.size(); ++p)
      parts.ports[t].push_back(port_spec(model, parts, task.ports[p], parts.tasks[t].ports[p]));
    parts.task_specs.push_back(task_spec(task, parts.tasks[t], parts.ports[t]));
  }
  for (std::size_t v = 0; v < model.variables.size(); ++v)
    add_given(model, parts, model.variables[v], parts.variables[v]);
  parts.spec.name = parts.draft.subsystem.text;
  parts.spec.rtpus = parts.rtpus;
  parts.spec.tasks = parts.task_specs;
  parts.spec.constants = parts.constants;
  parts.spec.operators = parts.operators;
  parts.spec.init_order = parts.init_order;
  parts.spec.start = parts.sets[parts.start].order;
}

}  // namespace chimera
