// SPDX-License-Identifier: Apache-2.0
// Rules on standby tasks: exactly the outputs of the primary, and never in one configuration with it.
#include <algorithm>
#include <set>

#include "chimera/description/draft_values.h"
#include "chimera/text/nearest.h"
#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

std::set<std::string> outputs(const TaskModel& task) {
  std::set<std::string> names;
  for (const LinkedPort& port : task.ports)
    if (port.is(CHIMERA_OUT_VAR)) names.insert(port.variable);
  return names;
}

std::string text(const std::set<std::string>& names) {
  return listed(std::vector<std::string>(names.begin(), names.end()));
}

/// The primary of `standby`; nullopt, with a fault, if it does not exist.
std::optional<std::size_t> primary_of(Model& model, std::size_t standby) {
  const Word& name = model.tasks[standby].draft->standby_for->task;
  const std::string who = "'standby_for' of task '" + model.tasks[standby].name() + "'";
  const auto primary = model.primary_of(standby);
  if (primary && *primary != standby && !model.tasks[*primary].draft->standby_for) return primary;
  std::vector<std::string> names;
  for (const TaskModel& task : model.tasks)
    if (&task != &model.tasks[standby] && !task.draft->standby_for) names.push_back(task.name());
  const std::string near = primary ? "" : nearest(name.text, names);
  const std::string found = !primary              ? " names the task '" + name.text + "', which is not there"
                            : *primary == standby ? " names the task itself"
                                                  : " names '" + name.text + "', which is itself a standby";
  model.error("standby-unknown", name.at, who + found, name.text, listed(names), near,
              near.empty() ? "it may stand in for: " + listed(names) : "");
  return std::nullopt;
}

/// A task that produces the variable and is neither the primary nor one of its standbys; nullptr: none.
const TaskModel* produced_elsewhere(const Model& model, const VariableModel& variable, std::size_t primary) {
  for (const PortRef ref : variable.producers)
    if (ref.task != primary && model.primary_of(ref.task) != primary) return &model.tasks[ref.task];
  return nullptr;
}

/// A standby produces the same outputs as its primary, so that no reader lacks one, and no output of another task.
void check_outputs(Model& model, std::size_t standby, std::size_t primary, Place at) {
  const TaskModel &task = model.tasks[standby], &other = model.tasks[primary];
  if (task.component == nullptr || other.component == nullptr) return;
  const std::set<std::string> mine = outputs(task), expected = outputs(other);
  const std::string who = "task '" + task.name() + "' stands in for '" + other.name() + "' and produces ";
  if (!std::includes(mine.begin(), mine.end(), expected.begin(), expected.end())) {
    model.error("standby-outputs", at, who + text(mine) + "; expected " + text(expected), text(mine), text(expected),
                {}, "link its outputs by alias");
    return;
  }
  for (const std::string& name : mine) {
    const VariableModel* variable = expected.contains(name) ? nullptr : model.variable(name);
    if (variable == nullptr) continue;
    const TaskModel* elsewhere = produced_elsewhere(model, *variable, primary);
    if (elsewhere == nullptr && variable->given == nullptr) continue;
    const std::string by = elsewhere != nullptr ? "task '" + elsewhere->name() + "'" : "the operator";
    model.error("standby-outputs", at, who + "'" + name + "', which comes from " + by + " too", name, text(expected),
                {}, "give that output another name by alias");
  }
}

/// The reason why the primary must not be killed for its silence alone, and the remedy.
std::pair<std::string, std::string> why_not_stale(const Model& model, const TaskModel& task, const TaskModel& other) {
  const Nanoseconds after = task.draft->standby_for->stale_after->value;
  const std::string rtpu = model.rtpus[task.rtpu].name.text;
  if (task.rtpu == other.rtpu)
    return {"it is on rtpu '" + rtpu + "' as '" + other.name() + "' is, and would be killed with it",
            "put one of them on another rtpu"};
  if (other.draft->server || (other.component != nullptr && other.component->is_aperiodic()))
    return {"'" + other.name() + "' is released by events, and is silent while there are none",
            "take 'stale_after' out"};
  if (!other.period || after.count / kStalePeriods >= other.period->count) return {};
  return {"it is " + say(after) + ", and the period of '" + other.name() + "' is " + say(*other.period) +
              ": between two cycles that are in time up to two periods may pass",
          "write at least " + say(Nanoseconds{kStalePeriods * other.period->count})};
}

void check_stale(Model& model, const TaskModel& task, const TaskModel& other) {
  const auto& after = task.draft->standby_for->stale_after;
  if (!after) return;
  const auto [why, remedy] = why_not_stale(model, task, other);
  if (!why.empty())
    model.error("standby-stale", after->at, "'stale_after' of standby '" + task.name() + "': " + why, say(after->value),
                {}, {}, remedy);
}

/// A hot standby cycles beside its primary, so no other task may see its effects.
void check_hot(Model& model, const TaskModel& task) {
  const DraftStandby& written = *task.draft->standby_for;
  if (!written.is_hot() || task.component == nullptr) return;
  const auto refuse = [&](const std::string& why, std::string_view port = {}) {
    model.error("standby-hot", Spot(written.hot->at, port),
                "task '" + task.name() + "' cannot be a hot standby: " + why, "true", "false", {},
                "take 'hot' out: it is then initialised, and turned ON when it takes over");
  };
  if (task.draft->server || task.component->is_aperiodic()) refuse("it is released by events");
  for (const LinkedPort& port : task.ports) {
    if (port.is(CHIMERA_RESOURCE))
      refuse("resource '" + port.name + "' would be used by it beside its primary", port.name);
    if (port.is(CHIMERA_OUT_CONST)) refuse("it produces the constant '" + port.name + "'", port.name);
  }
}

void check(Model& model, std::size_t standby, std::size_t primary) {
  const TaskModel &task = model.tasks[standby], &other = model.tasks[primary];
  const Place at = task.draft->standby_for->task.at;
  check_outputs(model, standby, primary, at);
  check_stale(model, task, other);
  check_hot(model, task);
  for (const SetModel& set : model.sets)
    if (set.has(standby) && set.has(primary))
      model.error(
          "standby-in-configuration", set.at,
          "configuration '" + set.name + "' names task '" + other.name() + "' and its standby '" + task.name() + "'",
          task.name(), "one of the two", {},
          "take '" + task.name() + "' out: it goes ON when '" + other.name() + "' fails");
  if (task.rtpu == other.rtpu)
    model.warn("standby-same-rtpu", at,
               "task '" + task.name() + "' and the task it stands in for, '" + other.name() + "', are both on rtpu '" +
                   model.rtpus[task.rtpu].name.text + "'",
               "a crash of that process takes both: put one of them on another rtpu");
}

}  // namespace

void pair_standbys(Model& model) {
  for (std::size_t t = 0; t < model.tasks.size(); ++t) {
    const auto& written = model.tasks[t].draft->standby_for;
    const auto primary = written ? model.task_named(written->task.text) : std::nullopt;
    if (!primary) continue;
    const Nanoseconds stale_after = written->stale_after ? written->stale_after->value : Nanoseconds{};
    model.standbys.push_back({TaskId(*primary), TaskId(t), stale_after, written->is_hot()});
  }
}

void check_standbys(Model& model) {
  for (std::size_t i = 0; i < model.tasks.size(); ++i) {
    if (!model.tasks[i].draft->standby_for) continue;
    if (const auto primary = primary_of(model, i)) check(model, i, *primary);
  }
}

}  // namespace chimera
