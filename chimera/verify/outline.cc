// SPDX-License-Identifier: Apache-2.0
// Makes the outline of a model, and its JSON.
#include "chimera/verify/outline.h"

#include <algorithm>

#include "chimera/description/criticality.h"
#include "chimera/description/yaml_words.h"
#include "chimera/text/value_text.h"
#include "chimera/verify/model.h"
#include "chimera/verify/values.h"

namespace chimera {
namespace {

std::string preset_text(const LinkedPort& port, const std::string& unit) {
  const PortDescriptor& declared = *port.declared;
  if (declared.initial.empty()) return {};
  const auto count = static_cast<std::uint32_t>(declared.initial.size() / declared.element_size);
  return value_text({declared.type, declared.element_size, count, count == 1, unit, declared.fields},
                    declared.initial);
}

OutlinePort port_of(const LinkedPort& port) {
  const PortDescriptor& declared = *port.declared;
  OutlinePort out;
  out.name = port.name;
  out.declared = declared.name;
  out.kind = declared.kind;
  out.doc = declared.doc;
  out.is_shared = declared.shared;
  out.is_parted = !port.parted_from.empty();
  out.variable = out.is_parted ? port.parted_from : port.variable;
  if (port.own != nullptr) out.own = *port.own;
  out.is_own_item = port.is_own_item;
  if (port.is(CHIMERA_RESOURCE)) {
    out.is_solved = true;
    return out;
  }
  out.is_solved = is_solved(port);
  out.type = port.type ? type_text(port) : declared.type_name;
  out.unit = !port.unit_text.empty() ? port.unit_text : port.unit || declared.unit.empty() ? "1" : declared.unit;
  out.shape = port.has_extents ? shape_text(port.extents) : declared.shape;
  out.preset = preset_text(port, out.unit);
  return out;
}

std::vector<OutlineRepeated> repeated_of(const TaskModel& task) {
  std::vector<OutlineRepeated> all;
  for (const PortDescriptor& declared : task.component->ports) {
    if (!declared.repeated) continue;
    const auto n = std::ranges::count(task.ports, &declared, &LinkedPort::declared);
    all.push_back({declared.name, declared.kind, static_cast<std::uint32_t>(n), declared.max_instances, declared.doc});
  }
  return all;
}

OutlineTask task_of(const Model& model, const TaskModel& task) {
  const DraftTask& draft = *task.draft;
  OutlineTask out;
  out.name = task.name();
  out.line = draft.name.at.line;
  out.component = draft.component.text;
  out.rtpu = model.rtpus[task.rtpu].name.text;
  out.rate_hz = task.rate_hz;
  out.has_own_rate = draft.rate.has_value();
  out.period = task.period.value_or(Nanoseconds{});
  out.deadline = task.deadline;
  out.budget = task.budget;
  out.criticality = task.criticality;
  if (draft.standby_for) out.standby_for = draft.standby_for->task.text;
  if (task.component == nullptr) return out;
  out.is_known = true;
  out.doc = task.component->doc;
  out.is_aperiodic = task.component->is_aperiodic();
  for (const LinkedPort& port : task.ports) out.ports.push_back(port_of(port));
  out.repeated = repeated_of(task);
  return out;
}

OutlineVariable variable_of(const VariableModel& variable) {
  OutlineVariable out;
  out.name = variable.name;
  out.is_constant = variable.is_constant;
  if (variable.given == nullptr) return out;
  out.origin = variable.is_default    ? Origin::kDefault
               : variable.is_constant ? Origin::kConstants
                                      : Origin::kOperator;
  out.given = variable.given->value;
  return out;
}

/// Joins each port to its variable, and takes type, unit and shape of a variable from its first port.
void link(const Model& model, Outline& outline) {
  for (std::size_t t = 0; t < outline.tasks.size(); ++t)
    for (std::size_t p = 0; p < outline.tasks[t].ports.size(); ++p) {
      const LinkedPort& port = model.port({t, p});
      const auto found = model.variable_index.find(outline.tasks[t].ports[p].variable);
      if (found == model.variable_index.end()) continue;
      OutlineVariable& variable = outline.variables[found->second];
      if (variable.is_constant == port.declared->is_constant())
        (port.is_producer() ? variable.producers : variable.consumers).push_back({t, p});
    }
  for (OutlineVariable& variable : outline.variables) {
    const auto& ports = variable.producers.empty() ? variable.consumers : variable.producers;
    if (ports.empty()) continue;
    const OutlinePort& first = outline.tasks[ports[0].task].ports[ports[0].port];
    variable.type = first.type;
    variable.unit = first.unit;
    variable.shape = first.shape;
  }
}

std::string condition_text(const DraftSet& draft) {
  if (!draft.safe_when) return {};
  const DraftCondition& condition = *draft.safe_when;
  const std::string element = condition.element ? "[" + std::to_string(*condition.element) + "]" : "";
  return condition.variable.text + element + ' ' + sign_of(condition.comparison) + ' ' + condition.value.text;
}

OutlineSet set_of(const Model& model, std::size_t index) {
  OutlineSet out;
  out.name = model.sets[index].name;
  for (const TaskId task : model.sets[index].tasks) out.tasks.push_back(model.tasks[task.index].name());
  if (index < model.draft.configurations.size()) out.safe_when = condition_text(model.draft.configurations[index]);
  return out;
}

// ---- JSON ----

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }
Json text_or_null(const Node& node) { return node.is_none() ? Json() : Json(written_text(node)); }
Json ns_or_null(Nanoseconds time) { return time.count == 0 ? Json() : Json(time.count); }

Json port_json(const OutlinePort& port) {
  return {{"port", port.name},
          {"declared", port.declared},
          {"kind", kind_name(port.kind)},
          {"type", port.type},
          {"unit", port.unit},
          {"shape", port.shape},
          {"solved", port.is_solved},
          {"variable", text_or_null(port.variable)},
          {"shared", port.is_shared},
          {"parted", port.is_parted},
          {"value", text_or_null(port.own)},
          {"default", text_or_null(port.preset)},
          {"doc", port.doc}};
}

Json task_json(const OutlineTask& task) {
  Json ports = Json::array(), repeated = Json::array();
  for (const OutlinePort& port : task.ports) ports.push_back(port_json(port));
  for (const OutlineRepeated& port : task.repeated)
    repeated.push_back({{"port", port.name},
                        {"kind", kind_name(port.kind)},
                        {"instances", port.instances},
                        {"max_instances", port.max_instances},
                        {"doc", port.doc}});
  return {{"task", task.name},
          {"line", task.line},
          {"component", task.component},
          {"known", task.is_known},
          {"doc", task.doc},
          {"rtpu", task.rtpu},
          {"rate_hz", task.rate_hz == 0 ? Json() : Json(task.rate_hz)},
          {"own_rate", task.has_own_rate},
          {"period_ns", ns_or_null(task.period)},
          {"deadline_ns", ns_or_null(task.deadline)},
          {"budget_ns", ns_or_null(task.budget)},
          {"criticality", criticality_name(task.criticality)},
          {"standby_for", text_or_null(task.standby_for)},
          {"aperiodic", task.is_aperiodic},
          {"ports", std::move(ports)},
          {"repeated", std::move(repeated)}};
}

Json variable_json(const Outline& outline, const OutlineVariable& variable) {
  constexpr const char* kOrigins[] = {nullptr, "operator", "constants", "default"};
  const char* origin = kOrigins[static_cast<std::size_t>(variable.origin)];
  const auto ends = [&](const std::vector<PortRef>& refs) {
    Json all = Json::array();
    for (const PortRef ref : refs) {
      const auto [task, port] = task_port(outline, ref);
      all.push_back({{"task", task}, {"port", port}});
    }
    return all;
  };
  return {{"variable", variable.name},
          {"constant", variable.is_constant},
          {"origin", origin == nullptr ? Json() : Json(origin)},
          {"value", text_or_null(variable.given)},
          {"type", variable.type},
          {"unit", variable.unit},
          {"shape", variable.shape},
          {"producers", ends(variable.producers)},
          {"consumers", ends(variable.consumers)}};
}

}  // namespace

Outline outline_of(const Model& model) {
  Outline outline;
  outline.subsystem = model.draft.subsystem.text;
  for (const TaskModel& task : model.tasks) outline.tasks.push_back(task_of(model, task));
  for (const VariableModel& variable : model.variables) outline.variables.push_back(variable_of(variable));
  link(model, outline);
  for (std::size_t s = 0; s < model.sets.size(); ++s) outline.configurations.push_back(set_of(model, s));
  outline.start = model.start;
  outline.rtpus = model.rtpus;
  outline.sequence = model.draft.sequence;
  return outline;
}

TaskPort task_port(const Outline& outline, PortRef ref) {
  return {outline.tasks[ref.task].name, outline.tasks[ref.task].ports[ref.port].name};
}

void name_ports(EditAct& act, const Outline& outline) {
  if (auto* join = std::get_if<JoinProducers>(&act); join != nullptr && join->lacks_ports) {
    const auto variable = std::ranges::find(outline.variables, join->variable, &OutlineVariable::name);
    if (variable == outline.variables.end()) return;
    for (const PortRef ref : variable->producers) join->producers.push_back(task_port(outline, ref));
  }
  auto* rename = std::get_if<RenameKey>(&act);
  if (rename == nullptr || !rename->lacks_ports || rename->path.size() != 2) return;
  const std::string &section = rename->path[0], &name = rename->path[1];
  if (section != "operator" && section != "constants" && section != "variables") return;
  for (const OutlineTask& task : outline.tasks)
    for (const OutlinePort& port : task.ports)
      if (port.variable == name && port.name == name) rename->ports.push_back({task.name, port.name});
}

Json outline_json(const Outline& outline) {
  Json tasks = Json::array(), variables = Json::array(), configurations = Json::array(), rtpus = Json::array();
  for (const OutlineTask& task : outline.tasks) tasks.push_back(task_json(task));
  for (const OutlineVariable& variable : outline.variables) variables.push_back(variable_json(outline, variable));
  for (const OutlineSet& set : outline.configurations)
    configurations.push_back(
        {{"configuration", set.name}, {"tasks", set.tasks}, {"safe_when", text_or_null(set.safe_when)}});
  for (const DraftRtpu& rtpu : outline.rtpus)
    rtpus.push_back({{"rtpu", rtpu.name.text},
                     {"cpu", rtpu.cpu.value},
                     {"policy", policy_name(rtpu.policy.value)},
                     {"executor", rtpu.preemptive.value ? "preemptive" : "executive"}});
  return {{"subsystem", outline.subsystem},
          {"tasks", std::move(tasks)},
          {"variables", std::move(variables)},
          {"configurations", std::move(configurations)},
          {"start", outline.configurations[outline.start].name},
          {"rtpus", std::move(rtpus)},
          {"sequence", sequence_json(outline.sequence)}};
}

}  // namespace chimera
