// SPDX-License-Identifier: Apache-2.0
// The two set equations of the 1994 paper, per configuration, and the producers of each variable.
#include <algorithm>
#include <set>

#include "chimera/runtime/set_equations.h"
#include "chimera/text/nearest.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

VariableModel& variable_of(Model& model, const std::string& name, bool is_constant) {
  const auto [entry, is_new] = model.variable_index.emplace(name, model.variables.size());
  if (is_new) {
    VariableModel variable;
    variable.name = name;
    variable.is_constant = is_constant;
    model.variables.push_back(std::move(variable));
  }
  return model.variables[entry->second];
}

void add_given(Model& model, const std::vector<NamedNode>& given, bool is_constant) {
  for (const NamedNode& value : given) {
    VariableModel& variable = variable_of(model, value.name.text, is_constant);
    if (variable.is_constant != is_constant)
      model.error("variable-and-constant", value.name.at,
                  "'" + value.name.text + "' is given under 'constants' and under 'operator'", value.name.text,
                  "one of the two", {}, "a constant is fixed at init; an operator variable changes while tasks are ON");
    else
      variable.given = &value;
  }
}

void refuse_both(Model& model, const LinkedPort& port) {
  if (model.sequence_of(port.task) != nullptr && port.declared->intermittent) return;  // rule_sequence.cc
  const bool is_constant = port.declared->is_constant();
  const char *constant = "constant", *state = "state variable";
  model.error("variable-and-constant", port,
              "'" + port.variable + "' is a " + (is_constant ? constant : state) + " here (" + model.say(port) +
                  ") and a " + (is_constant ? state : constant) + " elsewhere",
              port.variable, {}, {}, "rename one of the two: alias: {" + port.declared->name + ": another_name}");
}

/// An input with a default that no alias links.
bool is_optional(const LinkedPort& port) {
  return port.is(CHIMERA_IN_VAR) && !port.declared->initial.empty() && port.variable == port.declared->name;
}

void add_port(Model& model, PortRef ref) {
  LinkedPort& port = model.port(ref);
  if (!port.is_linked() || port.is(CHIMERA_IN_CONST) || is_optional(port)) return;
  VariableModel& variable = variable_of(model, port.variable, port.declared->is_constant());
  if (variable.is_constant == port.declared->is_constant()) {
    (port.is_producer() ? variable.producers : variable.consumers).push_back(ref);
    return;
  }
  refuse_both(model, port);
  Model::part(port);
}

/// Links an in-const only to a constant with a producer; otherwise its default counts (settle_constants).
void add_in_const(Model& model, PortRef ref) {
  LinkedPort& port = model.port(ref);
  if (!port.is(CHIMERA_IN_CONST) || port.own != nullptr) return;
  VariableModel* variable = model.variable(port.variable);
  if (variable == nullptr) return;
  if (variable->is_constant)
    variable->consumers.push_back(ref);
  else if (port.declared->initial.empty())
    refuse_both(model, port);
}

/// Links an optional input to the variable of its name if that is produced or given; otherwise to its default, the
/// operator variable TASK.PORT.
void add_optional(Model& model, PortRef ref) {
  LinkedPort& port = model.port(ref);
  if (!is_optional(port)) return;
  const VariableModel* known = model.variable(port.variable);
  if (known != nullptr && known->is_constant) {
    refuse_both(model, port);
    Model::part(port);
    return;
  }
  if (known == nullptr || (!known->is_given() && known->producers.empty()))
    port.variable = model.tasks[ref.task].name() + "." + port.variable;
  VariableModel& variable = variable_of(model, port.variable, false);
  if (!variable.is_given() && variable.producers.empty()) {
    variable.given = &model.defaults.emplace_back(NamedNode{{variable.name, port.at}, {}});
    variable.is_default = true;
    port.source = ConstSource::kDefault;
  }
  variable.consumers.push_back(ref);
}

std::vector<PortRef> producers_in(const VariableModel& variable, const SetModel& set) {
  std::vector<PortRef> out;
  for (const PortRef ref : variable.producers)
    if (set.has(ref.task)) out.push_back(ref);
  return out;
}

/// The variables of a configuration that an input in the unit of `port` could read.
std::vector<std::string> fitting(const Model& model, const LinkedPort& port, const SetModel& set) {
  std::vector<std::string> names;
  for (const VariableModel& variable : model.variables) {
    if (variable.is_constant || variable.is_default) continue;
    if (variable.given == nullptr && producers_in(variable, set).empty()) continue;
    if (!port.unit || !variable.unit || same(*port.unit, *variable.unit)) names.push_back(variable.name);
  }
  return names;
}

std::string unmet_remedy(const Model& model, const LinkedPort& port, const VariableModel& variable, const SetModel& set,
                         const std::string& near) {
  if (!variable.producers.empty()) {
    const std::string task = "'" + model.tasks[variable.producers[0].task].name() + "'";
    return "task " + task + " produces it and is not in '" + set.name + "': add it there";
  }
  if (!near.empty()) return "did you mean alias: {" + port.declared->name + ": " + near + "}?";
  return "add a task that produces it, or give it under 'operator'";
}

void report_unmet(Model& model, const UnmetInput& unmet) {
  const VariableModel& variable = model.variables[unmet.variable];
  const SetModel& set = model.sets[unmet.set];
  const LinkedPort& port = model.port(unmet.port);
  if (model.sequence_of(port.task) != nullptr) return;  // rule_sequence.cc
  const std::string near = nearest(variable.name, fitting(model, port, set));
  const std::string unit = port.unit && port.unit_text != "1" ? "; it is in " + port.unit_text : "";
  model.error("input-unmet", Spot(port).in(set),
              unmet.said + " has no producer in configuration '" + set.name + "'" + unit, variable.name,
              "a producer of '" + variable.name + "'", near,
              unmet_remedy(model, port, variable, set, near));
}

/// The producers without the standbys of other producers, because rule_standby.cc judges a task and its standby.
std::vector<PortRef> without_standbys(const Model& model, const std::vector<PortRef>& producers) {
  std::vector<PortRef> left;
  for (const PortRef ref : producers) {
    const auto primary = model.primary_of(ref.task);
    const auto is_primary = [&](const PortRef other) { return primary == other.task; };
    if (std::ranges::none_of(producers, is_primary)) left.push_back(ref);
  }
  return left;
}

/// An intermittent input needs a producer in some configuration only.
bool needs_producer(const Model& model, const VariableModel& variable, PortRef port) {
  return !model.port(port).declared->intermittent || variable.producers.empty();
}

using Members = std::vector<bool>;  // by task

Members members(const Model& model, const SetModel& set) {
  Members tasks(model.tasks.size());
  for (const TaskId task : set.tasks) tasks[task.index] = true;
  return tasks;
}

/// Tasks that may be ON in the set: its members, and standbys of members. The inputs of standbys must be met too.
Members readers(const Model& model, const Members& on) {
  Members tasks = on;
  for (const StandbySpec& each : model.standbys)
    if (on[each.primary.index]) tasks[each.standby.index] = true;
  return tasks;
}

SetFault fault_of(const Model& model, const VariableModel& variable, const Members& on, const Members& reading) {
  return set_fault(variable, [&](std::size_t task) -> bool { return on[task]; },
                   [&](PortRef port) { return reading[port.task] && needs_producer(model, variable, port); });
}

void report_two(Model& model, const VariableModel& variable, const SetModel& set) {
  const std::vector<PortRef> all = producers_in(variable, set), producers = producers_of(model, variable, set);
  if (variable.given != nullptr)
    model.error("operator-produced", Spot(variable.given->name.at, model.port(all[0])).in(set),
                "operator variable '" + variable.name + "' is produced by task '" +
                    model.tasks[all[0].task].name() + "' in configuration '" + set.name + "'",
                variable.name, "a variable without a producing task", {},
                "take it out of 'operator', or link the output elsewhere by alias");
  if (producers.size() < 2) return;
  const LinkedPort &first = model.port(producers[0]), &second = model.port(producers[1]);
  model.error("two-producers", Spot(second).in(set),
              "'" + variable.name + "' has two producers in configuration '" + set.name + "': " + model.say(first) +
                  " at " + Model::say(first.at) + " and " + model.say(second),
              variable.name, "one producer", {},
              "rename both by alias (" + variable.name + "_1, " + variable.name +
                  "_2) and join them with a component such as join_mean");
}

}  // namespace

std::vector<PortRef> producers_of(const Model& model, const VariableModel& variable, const SetModel& set) {
  return without_standbys(model, producers_in(variable, set));
}

void collect_variables(Model& model) {
  add_given(model, model.draft.constants, true);
  add_given(model, model.draft.operators, false);
  for (const auto add : {add_port, add_in_const, add_optional})
    for (std::size_t t = 0; t < model.tasks.size(); ++t)
      for (std::size_t p = 0; p < model.tasks[t].ports.size(); ++p) add(model, {t, p});
}

void refuse_two_producers(Model& model) {
  std::vector<Members> on;  // by set
  for (const SetModel& set : model.sets) on.push_back(members(model, set));
  for (const VariableModel& variable : model.variables)
    for (std::size_t s = 0; s < on.size(); ++s)
      if (!variable.is_constant && fault_of(model, variable, on[s], on[s]) == SetFault::kTwoProducers)
        report_two(model, variable, model.sets[s]);
}

void find_unmet_inputs(Model& model) {
  std::set<const LinkedPort*> found;
  for (std::size_t s = 0; s < model.sets.size(); ++s) {
    if (!model.sets[s].is_whole || model.draft.is_partial) continue;
    const Members on = members(model, model.sets[s]), reading = readers(model, on);
    for (std::size_t v = 0; v < model.variables.size(); ++v) {
      const VariableModel& variable = model.variables[v];
      if (variable.is_constant || fault_of(model, variable, on, reading) != SetFault::kNoProducer) continue;
      for (const PortRef ref : variable.consumers)
        if (reading[ref.task] && needs_producer(model, variable, ref) && found.insert(&model.port(ref)).second)
          model.unmet.push_back({ref, s, v, model.say(model.port(ref))});
    }
  }
  for (const UnmetInput& each : model.unmet)
    if (model.variables[each.variable].producers.empty()) model.unlink(each.port);
  model.has_unmet = model.has_unmet || !model.unmet.empty();
}

void refuse_unmet_inputs(Model& model) {
  for (const UnmetInput& each : model.unmet) report_unmet(model, each);
}

}  // namespace chimera
