// SPDX-License-Identifier: Apache-2.0
// Parses every written value once; its bytes stay in the model for the specs of the runtime.
#include "chimera/verify/rules/rules.h"
#include "chimera/verify/values.h"

namespace chimera {
namespace {

void check_own(Model& model, LinkedPort& port) {
  ValueTarget target{port, value_name(model, port)};
  target.is_quiet = model.sequence_of(port.task) != nullptr;  // rule_sequence.cc
  auto bytes = value_bytes(model, *port.own, target);
  if (bytes) port.value = *std::move(bytes);
}

/// A given value must fit all its readers; the first reader that refuses it gives the fault.
void check_given(Model& model, VariableModel& variable) {
  for (const PortRef ref : variable.consumers) {
    LinkedPort& port = model.port(ref);
    if (!is_solved(port)) continue;
    auto bytes = variable.is_written() ? value_bytes(model, variable.given->value, {port, value_name(variable)})
                                       : declared_bytes(port);
    if (!bytes) return;
    if (variable.value.empty()) variable.value = *bytes;
    if (port.is(CHIMERA_IN_CONST)) port.value = *std::move(bytes);
  }
}

void check_steps(Model& model, TaskModel& task) {
  for (const NamedNode& step : task.draft->max_step)
    for (LinkedPort& port : task.ports)
      if (port.declared->name == step.name.text && port.is(CHIMERA_OUT_VAR) && is_solved(port)) {
        ValueTarget target{port, "largest step of '" + step.name.text + "' of task '" + task.name() + "'"};
        target.is_step = true;
        if (auto bytes = value_bytes(model, step.value, target)) port.max_step = *std::move(bytes);
      }
}

void check_resources(Model& model, const TaskModel& task) {
  if (const auto& limit = task.draft->safe_after; limit && !task.has_resource() && task.component != nullptr)
    model.error("safe-after", limit->at,
                "task '" + task.name() + "' has 'safe_after', and component '" + task.component->name +
                    "' has no resource port: it has no device that could be told to idle",
                task.component->name, "a component with a resource port", {}, "take 'safe_after' out");
  for (const LinkedPort& port : task.ports) {
    if (!port.is(CHIMERA_RESOURCE) || port.own == nullptr) continue;
    if (!port.own->is_scalar())
      model.error("value-type", Spot(port.own->at, port),
                  "resource '" + port.name + "' of task '" + task.name() + "': expected a text", {}, "a text");
  }
}

const LinkedPort* same_resource(const LinkedPort& port, const TaskModel& other) {
  for (const LinkedPort& its : other.ports)
    if (its.is(CHIMERA_RESOURCE) && !its.declared->shared && its.own != nullptr && its.own->text == port.own->text)
      return &its;
  return nullptr;
}

/// Tasks that are never ON together use a resource in turn (runtime/plan/rivals.h). Tasks of one set open it at the
/// same time.
void check_users(Model& model, std::size_t a, std::size_t b) {
  const auto names_both = [&](const SetModel& set) { return set.has(a) && set.has(b); };
  const auto set = std::ranges::find_if(model.sets, names_both);
  if (set == model.sets.end()) return;
  for (const LinkedPort& port : model.tasks[a].ports) {
    if (!port.is(CHIMERA_RESOURCE) || port.declared->shared || port.own == nullptr || !port.own->is_scalar()) continue;
    if (const LinkedPort* its = same_resource(port, model.tasks[b]))
      model.warn("resource-twice", Spot(its->own->at, *its).in(*set),
                 "tasks '" + model.tasks[a].name() + "' and '" + model.tasks[b].name() + "' of configuration '" +
                     set->name + "' both open the resource '" + port.own->text + "'",
                 "give each a device of its own; where it takes several users, declare the port `shared`");
  }
}

}  // namespace

void check_values(Model& model) {
  for_each_port(model, [&](PortRef, LinkedPort& port) {
    if (!is_solved(port)) return;
    if (port.own != nullptr)
      check_own(model, port);
    else if (port.is(CHIMERA_OUT_VAR) || (port.is(CHIMERA_IN_CONST) && port.source == ConstSource::kDefault))
      port.value = declared_bytes(port);
  });
  for (VariableModel& variable : model.variables)
    if (variable.given != nullptr) check_given(model, variable);
  for (TaskModel& task : model.tasks) {
    check_steps(model, task);
    check_resources(model, task);
  }
  for (std::size_t a = 0; a < model.tasks.size(); ++a)
    for (std::size_t b = a + 1; b < model.tasks.size(); ++b)
      if (model.tasks[a].has_resource() && model.tasks[b].has_resource()) check_users(model, a, b);
}

}  // namespace chimera
