// SPDX-License-Identifier: Apache-2.0
// A verified model as the plain specs of the runtime: every link an id, every value the bytes that the rules accepted,
// every name a view into Parts.
#include <cstring>

#include "chimera/runtime/hosted/task_orders.h"
#include "chimera/verify/parts.h"

namespace chimera {
namespace {

using Parts = Configuration::Parts;

std::string_view keep(Parts& parts, std::string text) { return parts.texts.emplace_back(std::move(text)); }

std::span<const std::byte> keep(Parts& parts, std::vector<std::byte> bytes) {
  return parts.values.emplace_back(std::move(bytes));
}

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), bytes.size());
  return bytes;
}

void count_list(const Node& node, std::uint32_t (&listed)[CHIMERA_MAX_EXTENTS]) {
  const Node* at = &node;
  for (std::uint32_t& entries : listed) {
    if (!at->is_list() || at->items.empty()) return;
    entries = static_cast<std::uint32_t>(at->items.size());
    at = &at->items[0];
  }
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

/// Gives every variable that a port is linked to its id, and each port the id of what it is linked to.
class SpecMaker {
 public:
  SpecMaker(const Model& model, Parts& parts)
      : model_(model), parts_(parts), ids_(model.variables.size(), UINT32_MAX) {}

  void make() {
    number_variables();
    for (const DraftRtpu& rtpu : model_.rtpus)
      parts_.rtpus.push_back({keep(parts_, rtpu.name.text), rtpu.cpu.value, rtpu.policy.value, rtpu.preemptive.value});
    make_ports();
    for (std::size_t t = 0; t < model_.tasks.size(); ++t)
      parts_.task_specs.push_back(task_spec(model_.tasks[t], parts_.tasks[t], parts_.ports[t]));
    for (std::size_t v = 0; v < model_.variables.size(); ++v) add_given(v);
    parts_.links.fill(parts_.task_specs, parts_.operators, parts_.state_variables, parts_.constants);
  }

 private:
  /// State variables and constants are counted apart, in the order of the model.
  void number_variables() {
    for (std::size_t v = 0; v < model_.variables.size(); ++v) {
      const VariableModel& variable = model_.variables[v];
      const PortRef* first = !variable.producers.empty()   ? &variable.producers[0]
                             : !variable.consumers.empty() ? &variable.consumers[0]
                                                           : nullptr;
      if (first == nullptr) continue;
      if (variable.is_constant) {
        ids_[v] = static_cast<std::uint32_t>(parts_.constants.size());
        ConstantSpec& spec = parts_.constants.emplace_back();
        spec.name = parts_.variables[v].name;
        spec.type = *model_.port(*first).type;
        spec.element_bytes = model_.port(*first).element_bytes;
      } else {
        ids_[v] = static_cast<std::uint32_t>(parts_.state_variables.size());
        parts_.state_variables.emplace_back().name = parts_.variables[v].name;
        parts_.configured.push_back(v);
      }
    }
  }

  void make_ports() {
    parts_.ports.resize(model_.tasks.size());
    for (std::size_t t = 0; t < model_.tasks.size(); ++t) {
      const std::vector<LinkedPort>& ports = model_.tasks[t].ports;
      for (std::size_t p = 0; p < ports.size(); ++p)
        parts_.ports[t].push_back(port_spec(ports[p], parts_.tasks[t].ports[p]));
    }
    for (std::size_t v = 0; v < model_.variables.size(); ++v)
      for (const auto* refs : {&model_.variables[v].producers, &model_.variables[v].consumers})
        for (const PortRef ref : *refs) {
          PortSpec& port = parts_.ports[ref.task][ref.port];
          if (model_.variables[v].is_constant) port.constant = ConstantId(ids_[v]);
          else port.variable = VariableId(ids_[v]);
        }
  }

  PortSpec port_spec(const LinkedPort& port, const ConfiguredPort& configured) {
    PortSpec spec;
    spec.declared = port.index;
    spec.kind = port.declared->kind;
    spec.instance = port.instance;
    if (!port.is(CHIMERA_RESOURCE)) {
      spec.unit = configured.unit;
      spec.element_bytes = port.element_bytes;
      spec.type = *port.type;
      fill_extents(port, spec.extent);
      // A linked in-const has the value of its constant.
      if (port.source != ConstSource::kVariable && !port.value.empty()) spec.value = keep(parts_, port.value);
      if (!port.max_step.empty()) spec.max_step = keep(parts_, port.max_step);
    } else {
      spec.type = CHIMERA_STRING;
      spec.element_bytes = 0;
      spec.value = keep(parts_, bytes_of(port.own->text));
    }
    spec.safety = port.declared->safety;
    spec.has_range = port.declared->has_range;
    spec.min = port.declared->min;
    spec.max = port.declared->max;
    if (port.own != nullptr) count_list(*port.own, spec.listed);
    return spec;
  }

  void fill_extents(const LinkedPort& port, ExtentSpec (&out)[CHIMERA_MAX_EXTENTS]) const {
    for (std::size_t i = 0; i < port.extents.size(); ++i) {
      out[i].max = port.extents[i].max;
      const auto constant = model_.variable_index.find(port.extents[i].constant);
      if (constant != model_.variable_index.end()) out[i].constant = ConstantId(ids_[constant->second]);
    }
  }

  /// What the description itself says of a constant or an operator variable, where a task reads it.
  void add_given(std::size_t v) {
    const VariableModel& variable = model_.variables[v];
    if (variable.given == nullptr || variable.consumers.empty()) return;
    const std::span<const std::byte> value = keep(parts_, variable.value);
    if (variable.is_constant) {
      ConstantSpec& spec = parts_.constants[ids_[v]];
      spec.value = value;
      count_list(variable.given->value, spec.listed);
      return;
    }
    const LinkedPort& port = model_.port(variable.consumers[0]);
    GivenSpec& spec = parts_.operators.emplace_back();
    spec.name = parts_.variables[v].name;
    spec.variable = VariableId(ids_[v]);
    spec.type = *port.type;
    spec.element_bytes = port.element_bytes;
    fill_extents(port, spec.extent);
    spec.value = value;
    count_list(variable.given->value, spec.listed);
  }

  const Model& model_;
  Parts& parts_;
  std::vector<std::uint32_t> ids_;  // of state variables or constants, by index in Model::variables
};

}  // namespace

void fill_spec(const Model& model, Parts& parts) {
  SpecMaker(model, parts).make();
  parts.spec.name = parts.draft.subsystem.text;
  parts.spec.rtpus = parts.rtpus;
  parts.spec.tasks = parts.task_specs;
  parts.spec.variables = parts.state_variables;
  parts.spec.constants = parts.constants;
  parts.spec.operators = parts.operators;
  parts.spec.init_order = parts.init_order;
  parts.spec.start = parts.sets[parts.start].order;
  for (const ConfiguredSet& set : parts.sets) parts.named_sets.push_back({set.name, set.order});
  parts.spec.sets = parts.named_sets;
  parts.on_order = make_on_order(parts.spec);
  parts.spec.on_order = parts.on_order;
  parts.end_order = make_end_order(parts.spec);
  parts.spec.end_order = parts.end_order;
}

}  // namespace chimera
