// SPDX-License-Identifier: Apache-2.0
// Rules on configurations: the tasks they name, and the reactions that lead from one to another.
#include <optional>

#include "chimera/description/draft_values.h"
#include "chimera/text/nearest.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

std::vector<std::string> set_names(const Model& model) {
  std::vector<std::string> names;
  for (const SetModel& set : model.sets) names.push_back(set.name);
  return names;
}

std::vector<std::string> task_names(const Model& model) {
  std::vector<std::string> names;
  for (const DraftTask& task : model.draft.tasks) names.push_back(task.name.text);
  return names;
}

std::optional<std::size_t> find_set(Model& model, const Word& name, const std::string& who) {
  for (std::size_t i = 0; i < model.sets.size(); ++i)
    if (model.sets[i].name == name.text) return i;
  const std::vector<std::string> names = set_names(model);
  const std::string near = nearest(name.text, names);
  model.error("configuration-unknown", name.at,
              who + " names the configuration '" + name.text + "', which is not there", name.text, listed(names), near,
              near.empty() ? "there are: " + listed(names) : "");
  return std::nullopt;
}

void add_task(Model& model, SetModel& set, const Word& name) {
  const auto task = model.task_named(name.text);
  if (!task) {
    set.is_whole = false;
    const std::vector<std::string> names = task_names(model);
    const std::string near = nearest(name.text, names);
    model.error("task-unknown", name.at,
                "configuration '" + set.name + "' names the task '" + name.text + "', which is not there", name.text,
                listed(names), near, near.empty() ? "there are: " + listed(names) : "");
  } else if (set.has(*task)) {
    model.error("configuration-task-twice", name.at,
                "configuration '" + set.name + "' names the task '" + name.text + "' twice", name.text,
                "each task once", {}, "take one of the two out");
  } else {
    set.tasks.push_back(TaskId(*task));
    if (model.tasks[*task].is_partial()) set.is_whole = false;
  }
}

/// The one configuration of a description that declares none: every task but the standbys.
SetModel whole_set(const Model& model) {
  SetModel set;
  set.name = "all";
  if (!model.tasks.empty()) set.at = model.tasks[0].draft->name.at;
  for (std::size_t i = 0; i < model.tasks.size(); ++i) {
    if (model.tasks[i].draft->standby_for) continue;
    set.tasks.push_back(TaskId(i));
    if (model.tasks[i].is_partial()) set.is_whole = false;
  }
  return set;
}

void check_reactions(Model& model) {
  for (const TaskModel& task : model.tasks) {
    const DraftTask& draft = *task.draft;
    const auto check = [&](const Word& name, const char* key) {
      if (!name.empty()) find_set(model, name, "'" + std::string(key) + "' of task '" + task.name() + "'");
    };
    if (draft.on_miss) check(draft.on_miss->configuration, "on_miss");
    if (draft.on_overrun) check(draft.on_overrun->configuration, "on_overrun");
    if (draft.on_fault) check(draft.on_fault->configuration, "on_fault");
  }
}

}  // namespace

void make_sets(Model& model) {
  for (const DraftSet& draft : model.draft.configurations) {
    SetModel set;
    set.name = draft.name.text;
    set.at = draft.name.at;
    for (const Word& name : draft.tasks) add_task(model, set, name);
    if (draft.tasks.empty())
      model.error("configuration-empty", Spot(set.at).in(set), "configuration '" + set.name + "' has no task", {},
                  "a list of tasks", {}, "write " + set.name + ": [task, task], or take it out");
    model.sets.push_back(std::move(set));
  }
  if (model.sets.empty()) model.sets.push_back(whole_set(model));
  if (model.draft.start) model.start = find_set(model, *model.draft.start, "'start'").value_or(0);
  check_reactions(model);
}

}  // namespace chimera
