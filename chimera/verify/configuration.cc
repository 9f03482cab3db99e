// SPDX-License-Identifier: Apache-2.0
// Builds a configuration from a legal model, in two halves. Clients read names, types and links as texts. The runtime
// reads plain specs: ids for links, the accepted bytes for values, views into the parts for names.
#include "chimera/verify/configuration.h"

#include <algorithm>
#include <cstring>
#include <deque>

#include "chimera/runtime/hosted/links.h"
#include "chimera/runtime/hosted/task_orders.h"
#include "chimera/units/quantity.h"
#include "chimera/verify/model.h"
#include "chimera/verify/values.h"

namespace chimera {

/// Filled once, then never moved or changed: the spec points into them.
struct Configuration::Parts {
  Draft draft;
  std::vector<ConfiguredTask> tasks;
  std::vector<ConfiguredVariable> variables;
  std::vector<ConfiguredSet> sets;
  std::size_t start = 0;
  // Storage behind spec(). Elements of a deque never move.
  std::deque<std::string> texts;
  std::deque<std::vector<std::byte>> values;
  std::vector<RtpuSpec> rtpus;
  std::vector<std::vector<PortSpec>> ports;
  std::vector<TaskSpec> task_specs;
  std::vector<Variable> state_variables;
  std::vector<std::size_t> configured;  // index in `variables`, by VariableId
  std::vector<ConstantSpec> constants;
  std::vector<GivenSpec> operators;
  Links links;
  std::vector<TaskId> init_order, on_order, end_order;
  std::vector<NamedSet> named_sets;
  std::vector<StandbySpec> standbys;
  std::vector<RestartSpec> restarts;
  std::vector<StaleSpec> stale;
  ApplicationSpec spec;
};

namespace {

ConfiguredPort configured(const LinkedPort& port) {
  ConfiguredPort out;
  out.declared = port.index;
  out.instance = port.instance;
  out.kind = port.declared->kind;
  out.name = port.name;
  out.variable = port.variable;
  out.frame = port.declared->frame;
  out.at = port.at;
  if (port.is(CHIMERA_RESOURCE)) return out;
  out.type = type_text(port);
  out.unit = port.unit_text.empty() ? "1" : port.unit_text;
  out.shape = shape_text(port.extents);
  return out;
}

ConfiguredTask configured(const TaskModel& task) {
  ConfiguredTask out;
  out.name = task.name();
  out.component = task.component->name;
  out.doc = task.component->doc;
  out.at = task.draft->name.at;
  out.rtpu = task.rtpu;
  out.rate_hz = task.rate_hz;
  out.is_aperiodic = task.component->is_aperiodic();
  out.has_event_source = task.component->event_source;
  out.is_hardware = task.has_resource();
  if (const auto& standby = task.draft->standby_for) {
    out.standby_for = standby->task.text;
    if (standby->stale_after) out.stale_after = standby->stale_after->value;
    out.is_hot = standby->is_hot();
  }
  for (const LinkedPort& port : task.ports) out.ports.push_back(configured(port));
  return out;
}

/// The unit of the first number of the value that the file gives the variable.
WrittenUnit written_unit(const Model& model, const VariableModel& variable, const LinkedPort& port) {
  const Node* node = variable.is_written() ? &variable.given->value : port.own;
  while (node != nullptr && node->is_list() && !node->items.empty()) node = node->items.data();
  if (node == nullptr || !node->is_scalar() || node->quoted || !port.unit) return {};
  const auto quantity = parse_quantity(node->text, model.library.units());
  const auto from = quantity ? conversion(*port.unit, quantity->unit) : std::nullopt;
  return from ? WrittenUnit{quantity->unit_text, *from} : WrittenUnit{};
}

ConfiguredVariable configured(const Model& model, const VariableModel& variable) {
  ConfiguredVariable out;
  out.name = variable.name;
  out.is_constant = variable.is_constant;
  out.is_given = variable.given != nullptr;
  out.producers = variable.producers;
  out.consumers = variable.consumers;
  const LinkedPort* port = !variable.producers.empty()   ? &model.port(variable.producers[0])
                           : !variable.consumers.empty() ? &model.port(variable.consumers[0])
                                                         : nullptr;
  if (variable.given != nullptr)
    out.at = variable.given->name.at;
  else if (port != nullptr)
    out.at = port->at;
  if (port == nullptr) return out;  // given, but no task uses it
  const ConfiguredPort like = configured(*port);
  out.type = like.type;
  out.unit = like.unit;
  out.shape = like.shape;
  out.written = written_unit(model, variable, *port);
  return out;
}

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

/// The number of the configuration that a reaction names; UINT16_MAX if it names none.
std::uint16_t set_number(const Model& model, const Word& name) {
  for (std::size_t i = 0; i < model.sets.size(); ++i)
    if (model.sets[i].name == name.text) return static_cast<std::uint16_t>(i);
  return UINT16_MAX;
}

void take_reactions(const Model& model, const DraftTask& draft, TaskSpec& spec) {
  const auto take = [&](const auto& reaction, auto& kind, std::uint16_t& set) {
    if (!reaction) return;
    kind = reaction->kind;
    set = set_number(model, reaction->configuration);
  };
  take(draft.on_miss, spec.on_miss, spec.on_miss_set);
  take(draft.on_overrun, spec.on_overrun, spec.on_overrun_set);
  take(draft.on_fault, spec.on_fault, spec.on_fault_set);
}

void take_restarts(const Model& model, std::vector<RestartSpec>& restarts) {
  for (std::size_t t = 0; t < model.tasks.size(); ++t) {
    const auto& on_fault = model.tasks[t].draft->on_fault;
    if (!on_fault || on_fault->kind != OnFault::kRestart) continue;
    const DraftRestart& restart = on_fault->restart;
    restarts.push_back({TaskId(t), restart.most, restart.within, restart.then});
  }
}

void take_stale(const Model& model, std::vector<StaleSpec>& stale) {
  for (std::size_t t = 0; t < model.tasks.size(); ++t)
    if (const auto& after = model.tasks[t].draft->stale_after) stale.push_back({TaskId(t), after->value});
}

TaskSpec task_spec(const Model& model, const TaskModel& task, const ConfiguredTask& configured,
                   std::span<const PortSpec> ports) {
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
  take_reactions(model, draft, spec);
  if (draft.tolerate) spec.tolerated_misses = static_cast<std::uint16_t>(draft.tolerate->misses);
  if (draft.tolerate) spec.tolerated_of = static_cast<std::uint16_t>(draft.tolerate->of);
  spec.place = task.place;
  if (draft.stack_bytes) spec.stack_bytes = static_cast<std::uint32_t>(draft.stack_bytes->value);
  spec.aperiodic = configured.is_aperiodic;
  const bool is_preemptive = model.rtpus[task.rtpu].preemptive.value;
  spec.has_events = configured.has_event_source && !draft.server && !is_preemptive;
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

/// Gives an id to every variable that a port is linked to, and to each port the id of its variable.
class SpecMaker {
 public:
  SpecMaker(const Model& model, Parts& parts)
      : model_(model), parts_(parts), ids_(model.variables.size(), UINT32_MAX) {}

  void make() {
    number_variables();
    for (const DraftRtpu& rtpu : model_.rtpus)
      parts_.rtpus.push_back({keep(parts_, rtpu.name.text), rtpu.cpu.value, rtpu.policy.value, rtpu.preemptive.value,
                              link_spec(rtpu)});
    make_ports();
    for (std::size_t t = 0; t < model_.tasks.size(); ++t)
      parts_.task_specs.push_back(task_spec(model_, model_.tasks[t], parts_.tasks[t], parts_.ports[t]));
    for (std::size_t v = 0; v < model_.variables.size(); ++v) add_given(v);
    parts_.links.fill(parts_.task_specs, parts_.operators, parts_.state_variables, parts_.constants);
  }

 private:
  LinkSpec link_spec(const DraftRtpu& rtpu) {
    if (!rtpu.is_board()) return {};
    const DraftLink& link = *rtpu.link;
    return {keep(parts_, link.address.text), link.is_udp, link.baud.value, link.rate.value.period,
            link.stale_after.value};
  }

  /// Numbers state variables and constants separately, in the order of the model.
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
    spec.name = std::string_view(configured.name).substr(0, configured.name.find('['));
    if (!port.is(CHIMERA_RESOURCE)) {
      spec.unit = configured.unit;
      spec.element_bytes = port.element_bytes;
      spec.type = *port.type;
      fill_extents(port, spec.extent);
      // A linked in-const gets the value of its constant.
      if (port.source != ConstSource::kVariable && !port.value.empty()) spec.value = keep(parts_, port.value);
      if (!port.max_step.empty()) spec.max_step = keep(parts_, port.max_step);
    } else {
      spec.type = CHIMERA_STRING;
      spec.element_bytes = 0;
      spec.value = keep(parts_, bytes_of(port.own->text));
    }
    spec.safety = port.declared->safety;
    spec.shared = port.declared->shared;
    spec.intermittent = port.declared->intermittent;
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

  /// Adds the value that the description gives to a constant or an operator variable, if a task reads it.
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

SafeCondition safe_condition(const SetModel& set, const Parts& parts) {
  if (!set.safe_variable) return {};
  SafeCondition condition = set.safe_when;
  const auto at = std::ranges::find(parts.configured, *set.safe_variable);
  condition.variable = VariableId(static_cast<std::size_t>(at - parts.configured.begin()));
  return condition;
}

/// Fills the half for the runtime; `parts` has its tasks already.
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
  for (std::size_t s = 0; s < parts.sets.size(); ++s)
    parts.named_sets.push_back({parts.sets[s].name, parts.sets[s].order, safe_condition(model.sets[s], parts)});
  parts.spec.sets = parts.named_sets;
  parts.standbys = model.standbys;
  take_restarts(model, parts.restarts);
  parts.spec.standbys = parts.standbys;
  parts.spec.restarts = parts.restarts;
  take_stale(model, parts.stale);
  parts.spec.stale = parts.stale;
  parts.on_order = make_on_order(parts.spec);
  parts.spec.on_order = parts.on_order;
  parts.end_order = make_end_order(parts.spec);
  parts.spec.end_order = parts.end_order;
}

}  // namespace

Configuration::Configuration(const Model& model) {
  auto parts = std::make_shared<Parts>();
  parts->draft = model.draft;
  parts->start = model.start;
  parts->init_order = model.init_order;
  for (const TaskModel& task : model.tasks) parts->tasks.push_back(configured(task));
  for (const VariableModel& variable : model.variables) parts->variables.push_back(configured(model, variable));
  for (const SetModel& set : model.sets) parts->sets.push_back({set.name, set.at, set.order});
  fill_spec(model, *parts);
  parts_ = std::move(parts);
}

const std::string& Configuration::file() const noexcept { return parts_->draft.file; }
const std::string& Configuration::subsystem() const noexcept { return parts_->draft.subsystem.text; }
std::span<const ConfiguredTask> Configuration::tasks() const noexcept { return parts_->tasks; }
std::span<const ConfiguredVariable> Configuration::variables() const noexcept { return parts_->variables; }
const ConfiguredVariable& Configuration::variable(VariableId id) const noexcept {
  return parts_->variables[parts_->configured[id.index]];
}
std::span<const ConfiguredSet> Configuration::sets() const noexcept { return parts_->sets; }
std::size_t Configuration::start() const noexcept { return parts_->start; }
std::span<const RtpuSpec> Configuration::rtpus() const noexcept { return parts_->rtpus; }
const Draft& Configuration::draft() const noexcept { return parts_->draft; }
const ApplicationSpec& Configuration::spec() const noexcept { return parts_->spec; }

}  // namespace chimera
