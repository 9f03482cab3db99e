// SPDX-License-Identifier: Apache-2.0
// Inserts join_mean, join_priority or select, and gives each producer a variable of its own.
#include "chimera/description/edit/join_tree.h"

#include <algorithm>
#include <map>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/edit/edit_tree.h"
#include "chimera/description/edit/rename_tree.h"

namespace chimera {
namespace {

constexpr std::size_t kMostInputs = 16;  // instances of a repeated port

constexpr const char* component_of(JoinBy by) {
  return by == JoinBy::kMean ? "join_mean" : by == JoinBy::kPriority ? "join_priority" : "select";
}

Node map_node() {
  Node node;
  node.kind = Node::Kind::kMap;
  return node;
}

void add(Node& map, const char* key, Node value) { insert_key(map, map.keys.size(), key, std::move(value)); }

/// The primary of a standby, else the task itself: both have one input of the join.
std::string group_of(Node& root, const std::string& task) {
  for (const EditPath& path : {EditPath{"tasks", task, "standby_for"}, EditPath{"tasks", task, "standby_for", "task"}})
    if (const Node* primary = found(root, path); primary != nullptr && primary->is_scalar()) return primary->text;
  return task;
}

/// `stem`_1, `stem`_2 ..., the first that is free.
template <class IsUsed>
std::string free_name(const std::string& stem, std::size_t& number, IsUsed is_used) {
  std::string name;
  do name = stem + "_" + std::to_string(++number);
  while (is_used(name));
  return name;
}

/// The value of `key` in the first producer that has one.
const Node* of_producers(Node& root, const JoinProducers& act, const char* key) {
  for (const TaskPort& producer : act.producers)
    if (const Node* value = found(root, {"tasks", producer.task, key}); value != nullptr) return value;
  return nullptr;
}

Node without_place(Node node) {
  node.at = {};
  return node;
}

Node join_task(Node& root, const JoinProducers& act, const std::vector<std::string>& inputs) {
  Node task = map_node(), alias = map_node(), in;
  in.kind = Node::Kind::kList;
  for (const std::string& input : inputs) in.items.push_back(scalar_node(input));
  add(task, "component", scalar_node(component_of(act.by)));
  for (const char* key : {"rtpu", "rate"})
    if (const Node* value = of_producers(root, act, key); value != nullptr && value->is_scalar())
      add(task, key, without_place(*value));
  add(alias, "in", std::move(in));
  if (act.by == JoinBy::kSelect) add(alias, "which", scalar_node(act.variable + "_which"));
  add(alias, "out", scalar_node(act.variable));
  if (act.by == JoinBy::kPriority) add(alias, "chosen", scalar_node(act.variable + "_chosen"));
  add(task, "alias", std::move(alias));
  return task;
}

/// Behind the last producer of the list, if it has one.
void add_member(Node& members, const JoinProducers& act, const std::string& name) {
  std::size_t place = 0;
  for (std::size_t i = 0; i < members.items.size(); ++i)
    for (const TaskPort& producer : act.producers)
      if (members.items[i].text == producer.task) place = i + 1;
  if (place > 0) members.items.insert(members.items.begin() + static_cast<std::ptrdiff_t>(place), scalar_node(name));
}

Result<void> check_producers(Node& root, const JoinProducers& act, const EditPath& path) {
  if (const auto legal = check_new_name(path, act.variable + "_chosen"); !legal) return legal;
  if (act.producers.size() < 2) return no_edit(path, "a join needs two producers; name task and port of each");
  for (const TaskPort& producer : act.producers)
    if (found(root, {"tasks", producer.task}) == nullptr)
      return no_edit({"tasks", producer.task}, "there is no such task");
  return {};
}

}  // namespace

Result<void> join_producers(Node& root, const JoinProducers& act) {
  const EditPath path = {"variables", act.variable};
  if (auto fine = check_producers(root, act, path); !fine) return fine;
  std::map<std::string, std::string> variable_of;  // by group
  std::vector<std::string> inputs;
  std::size_t number = 0;
  for (const TaskPort& producer : act.producers) {
    std::string& variable = variable_of[group_of(root, producer.task)];
    if (variable.empty()) {
      variable = free_name(act.variable, number, [&](const auto& name) { return is_variable_named(root, name); });
      inputs.push_back(variable);
    }
    if (auto linked = link_port(root, {producer.task, producer.port, variable, std::nullopt}); !linked) return linked;
  }
  if (inputs.size() < 2) return no_edit(path, "all producers stand by for one task: there is nothing to join");
  if (inputs.size() > kMostInputs)
    return no_edit(path, "a join has at most " + std::to_string(kMostInputs) + " inputs");
  Node& tasks = *found(root, {"tasks"});
  std::string name = "join_" + act.variable;
  for (std::size_t n = 1; tasks.find(name) != nullptr;)
    name = free_name("join_" + act.variable, n, [&](const auto& other) { return tasks.find(other) != nullptr; });
  std::size_t place = 0;
  for (std::size_t i = 0; i < tasks.keys.size(); ++i)
    for (const TaskPort& producer : act.producers)
      if (tasks.keys[i].text == producer.task) place = i + 1;
  insert_key(tasks, place, name, join_task(root, act, inputs));
  if (Node* sets = found(root, {"configurations"}))
    for (Node& set : sets->items)
      if (Node* members = set.is_map() ? found(set, {"tasks"}) : &set) add_member(*members, act, name);
  if (act.by != JoinBy::kSelect) return {};
  const auto which = made(root, {"operator", act.variable + "_which"});
  if (!which) return which.error();
  if ((*which)->is_none()) **which = scalar_node("0");
  return {};
}

}  // namespace chimera
