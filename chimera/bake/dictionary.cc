// SPDX-License-Identifier: Apache-2.0
// Lists tasks, configurations and variables of an image with their numbers.
#include "chimera/bake/dictionary.h"

#include "chimera/text/json.h"

namespace chimera::bake {
namespace {

Json tasks_of(const ApplicationSpec& spec) {
  Json tasks = Json::array();
  for (std::size_t i = 0; i < spec.tasks.size(); ++i) {
    Json task = Json::object();
    task["number"] = i;
    task["name"] = spec.tasks[i].name;
    task["component"] = spec.tasks[i].component;
    task["period_ns"] = spec.tasks[i].period.count;
    tasks.push_back(std::move(task));
  }
  return tasks;
}

Json configurations_of(const ApplicationSpec& spec) {
  Json sets = Json::array();
  for (std::size_t i = 0; i < spec.sets.size(); ++i) {
    Json tasks = Json::array();
    for (const TaskId task : spec.sets[i].order) tasks.push_back(spec.tasks[task.index].name);
    Json set = Json::object();
    set["number"] = i;
    set["name"] = spec.sets[i].name;
    set["tasks"] = std::move(tasks);
    sets.push_back(std::move(set));
  }
  return sets;
}

Json variable(std::size_t number, const char* kind, const ConfiguredVariable& configured) {
  Json made = Json::object();
  made["number"] = number;
  made["name"] = configured.name;
  made["kind"] = kind;
  made["type"] = configured.type;
  made["shape"] = configured.shape;
  made["unit"] = configured.unit;
  return made;
}

Json variables_of(const BakedApplication& application) {
  const ApplicationSpec& spec = application.spec();
  const Configuration& configuration = application.configuration();
  Json variables = Json::array();
  for (std::size_t i = 0; i < spec.variables.size(); ++i)
    variables.push_back(variable(i, spec.variables[i].is_given() ? "operator" : "variable",
                                 configuration.variable(VariableId(i))));
  for (std::size_t i = 0; i < spec.constants.size(); ++i)
    for (const ConfiguredVariable& each : configuration.variables())
      if (each.is_constant && each.name == spec.constants[i].name) variables.push_back(variable(i, "constant", each));
  return variables;
}

}  // namespace

std::string dictionary_text(const BakedApplication& application, const Target& target) {
  Json all = Json::object();
  all["subsystem"] = application.spec().name;
  all["target"] = target.name;
  all["tasks"] = tasks_of(application.spec());
  all["configurations"] = configurations_of(application.spec());
  all["variables"] = variables_of(application);
  return all.dump(Json::Style::kLines) + "\n";
}

}  // namespace chimera::bake
