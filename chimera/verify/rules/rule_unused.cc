// SPDX-License-Identifier: Apache-2.0
// Warnings about values, tasks and rtpus without a use.
#include <algorithm>

#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

void warn_of_values(Model& model) {
  for (const VariableModel& variable : model.variables)
    if (variable.given != nullptr && variable.consumers.empty())
      model.warn("unused", variable.given->name.at,
                 std::string(variable.is_constant ? "constant '" : "operator variable '") + variable.name +
                     "' is used by no task",
                 "take it out, or link an input to it by alias");
}

void warn_of_tasks(Model& model) {
  for (std::size_t i = 0; i < model.tasks.size(); ++i) {
    const TaskModel& task = model.tasks[i];
    const bool listed = std::any_of(model.sets.begin(), model.sets.end(), [i](const SetModel& s) { return s.has(i); });
    if (!listed && !task.draft->standby_for)
      model.warn("unused", task.draft->name.at, "task '" + task.name() + "' is in no configuration, so it stays OFF",
                 "name it in a configuration, or take it out");
    if (task.draft->on_overrun && !task.draft->budget)
      model.warn("unused", task.draft->on_overrun->at,
                 "'on_overrun' of task '" + task.name() + "' never applies: the task has no budget",
                 "write budget: 40 us");
  }
}

void warn_of_rtpus(Model& model) {
  for (std::size_t i = 0; i < model.draft.rtpus.size(); ++i)
    if (std::none_of(model.tasks.begin(), model.tasks.end(), [i](const TaskModel& t) { return t.rtpu == i; }))
      model.warn("unused", model.rtpus[i].name.at, "rtpu '" + model.rtpus[i].name.text + "' has no task",
                 "take it out, or place a task on it");
}

}  // namespace

void warn_of_unused(Model& model) {
  if (model.is_incomplete()) return;
  warn_of_values(model);
  warn_of_tasks(model);
  warn_of_rtpus(model);
}

}  // namespace chimera
