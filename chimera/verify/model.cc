// SPDX-License-Identifier: Apache-2.0
// Finds tasks and variables of the model and adds faults to its report.
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
  return std::find(tasks.begin(), tasks.end(), task) != tasks.end();
}

std::optional<std::size_t> Model::task_named(std::string_view name) const {
  for (std::size_t i = 0; i < draft.tasks.size(); ++i)
    if (draft.tasks[i].name.text == name) return i;
  return std::nullopt;
}

VariableModel* Model::variable(std::string_view name) {
  const auto found = variable_index.find(name);
  return found == variable_index.end() ? nullptr : &variables[found->second];
}

bool Model::is_incomplete() const noexcept {
  return draft.is_partial || std::any_of(tasks.begin(), tasks.end(), [](const TaskModel& t) { return t.is_partial(); });
}

void Model::error(std::string_view rule, Place at, std::string message, std::string found, std::string expected,
                  std::string nearest, std::string remedy) {
  report.add({.rule = rule,
              .at = at,
              .message = std::move(message),
              .found = std::move(found),
              .expected = std::move(expected),
              .nearest = std::move(nearest),
              .remedy = std::move(remedy)});
}

void Model::warn(std::string_view rule, Place at, std::string message, std::string remedy) {
  report.add({.rule = rule,
              .at = at,
              .message = std::move(message),
              .found = {},
              .expected = {},
              .nearest = {},
              .remedy = std::move(remedy),
              .severity = Severity::kWarning});
}

std::string Model::say(const LinkedPort& port) const {
  constexpr const char* kWords[] = {"input",    "output",       "in-const",     "out-const",
                                    "resource", "input stream", "output stream"};
  std::string out = std::string(kWords[port.declared->kind]) + " '" + port.name + "'";
  if (port.is_linked() && port.variable != port.name) out += " (variable '" + port.variable + "')";
  return out + " of task '" + tasks[port.task].name() + "'";
}

}  // namespace chimera
