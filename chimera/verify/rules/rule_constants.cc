// SPDX-License-Identifier: Apache-2.0
// The two set equations of the 1994 paper for constants, and the order in which tasks are initialised.
#include <algorithm>

#include "chimera/verify/rules/rules.h"

namespace chimera {
namespace {

void settle(Model& model, LinkedPort& port) {
  const VariableModel* variable = model.variable(port);
  const bool produced = variable != nullptr && variable->is_constant;
  if (port.own != nullptr) {
    port.source = ConstSource::kOwn;
    if (port.variable != port.declared->name)
      model.error("constant-produced", port,
                  model.say(port) + " is linked by 'alias' and given a value under 'constants'", port.name,
                  "one of the two", {}, "take one of the two out");
  } else if (produced) {
    port.source = ConstSource::kVariable;
    return;
  } else if (!port.declared->initial.empty()) {
    port.source = ConstSource::kDefault;
  } else if (variable == nullptr && !model.is_incomplete()) {
    model.error("constant-unmet", port, model.say(port) + " has no producer and no default", port.variable,
                "a value", {}, "write constants: {" + port.declared->name + ": ...} for the task or for the file");
  }
  port.variable.clear();
}

void refuse_two(Model& model, const VariableModel& variable) {
  if (variable.given != nullptr && !variable.producers.empty()) {
    const LinkedPort& port = model.port(variable.producers[0]);
    model.error("constant-produced", Spot(variable.given->name.at, port),
                "constant '" + variable.name + "' is given here and produced by " + model.say(port) + " at " +
                    Model::say(port.at),
                variable.name, "one producer", {}, "take it out here, or link the output elsewhere by alias");
  }
  for (const SetModel& set : model.sets) {
    const std::vector<PortRef> producers = producers_of(model, variable, set);
    if (producers.size() < 2) continue;
    const LinkedPort &first = model.port(producers[0]), &second = model.port(producers[1]);
    model.error("constant-two-producers", Spot(second).in(set),
                "constant '" + variable.name + "' has two producers in configuration '" + set.name +
                    "': " + model.say(first) + " at " + Model::say(first.at) + " and " + model.say(second),
                variable.name, "one producer", {}, "link one of them elsewhere by alias");
    return;
  }
}

/// True if several primaries produce the constant. A standby uses the constants of its primary, so it does not count.
bool has_several(const Model& model, const VariableModel& variable) {
  std::size_t n = 0;
  for (const PortRef ref : variable.producers) n += model.tasks[ref.task].draft->standby_for ? 0 : 1;
  return n > 1;
}

bool reads(const LinkedPort& port, const VariableModel& constant) {
  return port.is(CHIMERA_IN_CONST) && port.source == ConstSource::kVariable && port.variable == constant.name;
}

/// The in-const that reads the constant, or a port with it as an extent; nullptr: the task does not use it.
const LinkedPort* user_of(const TaskModel& task, const VariableModel& constant) {
  for (const LinkedPort& port : task.ports) {
    if (reads(port, constant)) return &port;
    for (const SolvedExtent& extent : port.extents)
      if (extent.constant == constant.name) return &port;
  }
  return nullptr;
}

/// If a constant has several producers, each configuration with a user must contain one of them.
void require_one(Model& model, const VariableModel& variable) {
  for (const SetModel& set : model.sets) {
    if (!set.is_whole || model.draft.is_partial || !producers_of(model, variable, set).empty()) continue;
    for (const TaskId task : set.tasks) {
      const LinkedPort* user = user_of(model.tasks[task.index], variable);
      if (user == nullptr) continue;
      model.error("constant-unmet", Spot(model.tasks[task.index].draft->name.at, *user).in(set),
                  (reads(*user, variable) ? "" : "the extent of ") + model.say(*user) +
                      " has no producer in configuration '" + set.name + "'; constant '" + variable.name +
                      "' is produced by tasks of other configurations",
                  variable.name, "a producer of '" + variable.name + "'", {},
                  "add task '" + model.tasks[variable.producers[0].task].name() + "' or another producer there");
      break;
    }
  }
}

bool is_producer(const VariableModel& variable, std::size_t task) {
  return std::ranges::any_of(variable.producers, [task](const PortRef from) { return from.task == task; });
}

/// A port whose extent a constant gives waits for that constant, even if its task has no port for it.
void add_extent_users(const Model& model, const LinkedPort& port, std::vector<std::vector<std::size_t>>& users) {
  for (const SolvedExtent& extent : port.extents) {
    const auto constant = model.variable_index.find(extent.constant);
    if (constant == model.variable_index.end()) continue;
    const VariableModel& variable = model.variables[constant->second];
    if (is_producer(variable, port.task)) continue;
    for (const PortRef from : variable.producers) users[from.task].push_back(port.task);
  }
}

/// users[a] has b if b needs a constant of a, in any configuration, because every task is initialised. A producer of a
/// constant uses its own value, not that of a producer of another configuration.
std::vector<std::vector<std::size_t>> users_of(const Model& model) {
  std::vector<std::vector<std::size_t>> users(model.tasks.size());
  for (const VariableModel& variable : model.variables) {
    if (!variable.is_constant || variable.producers.empty()) continue;
    for (const PortRef from : variable.producers)
      for (const PortRef to : variable.consumers)
        if (from.task == to.task || !is_producer(variable, to.task)) users[from.task].push_back(to.task);
  }
  for (const TaskModel& task : model.tasks)
    for (const LinkedPort& port : task.ports) add_extent_users(model, port, users);
  return users;
}

/// Finds a circle among tasks that all wait for others: follows producers backwards until one repeats.
std::vector<std::size_t> find_circle(const std::vector<std::vector<std::size_t>>& users,
                                     const std::vector<bool>& done) {
  std::size_t at = static_cast<std::size_t>(std::find(done.begin(), done.end(), false) - done.begin());
  std::vector<std::size_t> walk;
  while (std::find(walk.begin(), walk.end(), at) == walk.end()) {
    walk.push_back(at);
    for (std::size_t from = 0; from < users.size(); ++from) {
      const auto& to = users[from];
      if (done[from] || std::find(to.begin(), to.end(), walk.back()) == to.end()) continue;
      at = from;
      break;
    }
  }
  walk.erase(walk.begin(), std::find(walk.begin(), walk.end(), at));
  std::reverse(walk.begin(), walk.end());
  std::rotate(walk.begin(), std::min_element(walk.begin(), walk.end()), walk.end());
  return walk;
}

void report_circle(Model& model, const std::vector<std::size_t>& circle) {
  std::string path;
  for (const std::size_t task : circle) path += "'" + model.tasks[task].name() + "' -> ";
  path += "'" + model.tasks[circle[0]].name() + "'";
  model.error("constant-circle", model.tasks[circle[0]].draft->name.at,
              "constants in a circle: " + path + "; no task of it can be initialised first", {}, {}, {},
              "give one of these constants a value under 'constants' of its user");
}

}  // namespace

void settle_constants(Model& model) {
  for (TaskModel& task : model.tasks)
    for (LinkedPort& port : task.ports)
      if (port.is(CHIMERA_IN_CONST)) settle(model, port);
  for (const VariableModel& variable : model.variables)
    if (variable.is_constant) refuse_two(model, variable);
}

void order_constants(Model& model) {
  for (const VariableModel& variable : model.variables)
    if (variable.is_constant && has_several(model, variable)) require_one(model, variable);
  const auto users = users_of(model);
  std::vector<std::size_t> waits(model.tasks.size(), 0);
  for (const auto& to : users)
    for (const std::size_t task : to) ++waits[task];
  std::vector<bool> done(model.tasks.size(), false);
  while (model.init_order.size() < model.tasks.size()) {
    std::size_t next = model.tasks.size();
    for (std::size_t i = model.tasks.size(); i-- > 0;)
      if (!done[i] && waits[i] == 0) next = i;
    if (next == model.tasks.size()) {
      report_circle(model, find_circle(users, done));
      return;
    }
    done[next] = true;
    model.init_order.push_back(TaskId(next));
    for (const std::size_t task : users[next]) --waits[task];
  }
}

}  // namespace chimera
