// SPDX-License-Identifier: Apache-2.0
// Finds tasks and variables of the model, names them in texts, and adds faults to the report.
#include "chimera/verify/model.h"

#include <algorithm>

namespace chimera {

bool TaskModel::has_inputs() const noexcept {
  return std::any_of(ports.begin(), ports.end(), [](const LinkedPort& p) { return p.is(CHIMERA_IN_VAR); });
}

bool TaskModel::has_resource() const noexcept {
  return component != nullptr && std::any_of(component->ports.begin(), component->ports.end(),
                                             [](const auto& p) { return p.kind == CHIMERA_RESOURCE; });
}

bool SetModel::has(std::size_t task) const noexcept {
  return std::find(tasks.begin(), tasks.end(), TaskId(task)) != tasks.end();
}

std::optional<std::size_t> Model::task_named(std::string_view name) const {
  for (std::size_t i = 0; i < draft.tasks.size(); ++i)
    if (draft.tasks[i].name.text == name) return i;
  return std::nullopt;
}

std::optional<std::size_t> Model::primary_of(std::size_t standby) const {
  for (const StandbySpec& each : standbys)
    if (each.standby.index == standby) return each.primary.index;
  return std::nullopt;
}

VariableModel* Model::variable(std::string_view name) {
  const auto found = variable_index.find(name);
  return found == variable_index.end() ? nullptr : &variables[found->second];
}

void Model::unlink(PortRef ref) {
  VariableModel& of = *variable(port(ref));
  const auto is_it = [&](const PortRef other) { return other.task == ref.task && other.port == ref.port; };
  std::erase_if(of.producers, is_it);
  std::erase_if(of.consumers, is_it);
  part(port(ref));
  has_unmet = true;
}

bool Model::is_incomplete() const noexcept {
  return draft.is_partial || std::any_of(tasks.begin(), tasks.end(), [](const TaskModel& t) { return t.is_partial(); });
}

void Model::add(const Spot& spot, Fault fault) {
  fault.at = spot.at;
  if (spot.set != nullptr) fault.set = spot.set->name;
  if (spot.task) fault.task = tasks[*spot.task].name();
  fault.port = spot.port;
  report.add(std::move(fault));
}

void Model::error(std::string_view rule, const Spot& spot, std::string message, std::string found,
                  std::string expected, std::string nearest, std::string remedy) {
  add(spot, {.rule = rule,
             .message = std::move(message),
             .found = std::move(found),
             .expected = std::move(expected),
             .nearest = std::move(nearest),
             .remedy = std::move(remedy)});
}

void Model::warn(std::string_view rule, const Spot& spot, std::string message, std::string remedy) {
  add(spot, {.rule = rule,
             .message = std::move(message),
             .remedy = std::move(remedy),
             .severity = Severity::kWarning});
}

std::string Model::say(const LinkedPort& port) const {
  if (const DraftSequence* sequence = sequence_of(port.task); sequence != nullptr && port.declared->intermittent)
    return "variable '" + port.variable + "' of 'until' of " + sequence->say(sequence->step_of_input(port.instance));
  constexpr const char* kWords[] = {"input",    "output",       "in-const",     "out-const",
                                    "resource", "input stream", "output stream"};
  std::string out = std::string(kWords[port.declared->kind]) + " '" + port.name + "'";
  if (port.is_linked() && port.variable != port.name) out += " (variable '" + port.variable + "')";
  return out + " of task '" + tasks[port.task].name() + "'";
}

std::string type_text(const LinkedPort& port) {
  if (port.declared->type == CHIMERA_STRUCT) return port.declared->type_name;
  const std::string name(type_name(*port.type));
  return *port.type == CHIMERA_STRING ? name + '[' + std::to_string(port.element_bytes) + ']' : name;
}

std::string settled_by(const Model& model, const VariableModel& variable, const std::optional<PortRef>& from) {
  if (from) {
    const LinkedPort& port = model.port(*from);
    return model.say(port) + " at " + Model::say(port.at);
  }
  return "the value at " + Model::say(variable.given->value.at);
}

}  // namespace chimera
