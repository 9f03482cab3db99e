// SPDX-License-Identifier: Apache-2.0
// Follows a name through the tree of a description: lists of tasks, reactions, standbys, aliases, conditions,
// constants, steps of a sequence.
#include "chimera/description/edit/rename_tree.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/edit/edit_tree.h"
#include "chimera/description/yaml_words.h"
#include "chimera/text/nearest.h"

namespace chimera {
namespace {

bool is_letter_of_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

template <class Visit>
void each_item(Node* node, Visit visit) {
  if (node != nullptr)
    for (Node& item : node->items) visit(item);
}

/// The list of steps; nullptr: there is none.
Node* steps_of(Node& root) {
  Node* const sequence = found(root, {"sequence"});
  Node* const steps = sequence != nullptr && sequence->is_map() ? found(*sequence, {"steps"}) : sequence;
  return steps != nullptr && steps->is_list() ? steps : nullptr;
}

struct NameChange {
  const std::string& from;
  const std::string& to;
  std::size_t places = 0;

  void scalar(Node* node) {
    if (node == nullptr || !node->is_scalar() || node->text != from) return;
    node->text = to;
    node->quoted = node->quoted || needs_quotes(to, true);
    ++places;
  }
  void scalars(Node& node) {
    scalar(&node);
    each_item(&node, [this](Node& item) { scalar(&item); });
  }
  void key(Node* map) {
    if (map == nullptr) return;
    for (Word& key : map->keys) {
      if (key.text != from) continue;
      key.text = to;
      ++places;
    }
  }
  /// The name at the front of a condition: "q[2] > 0".
  void condition(Node* node) {
    if (node == nullptr || !node->is_scalar()) return;
    std::string& text = node->text;
    const std::size_t begin = std::min(text.find_first_not_of(' '), text.size());
    std::size_t end = begin;
    while (end < text.size() && is_letter_of_name(text[end])) ++end;
    if (text.substr(begin, end - begin) != from) return;
    text.replace(begin, end - begin, to);
    ++places;
  }
  /// A constant that is the name, or lists of tasks with it: "--on pid --off lqr".
  void constant(Node& node) {
    each_item(&node, [this](Node& item) { constant(item); });
    if (!node.is_scalar() || !node.text.starts_with("--")) return scalar(&node);
    std::string words;
    for (std::size_t at = 0, end = 0; at < node.text.size(); at = end + 1) {
      end = std::min(node.text.find(' ', at), node.text.size());
      const std::string word = node.text.substr(at, end - at);
      words += (word == from ? to : word) + (end < node.text.size() ? " " : "");
      places += word == from ? 1 : 0;
    }
    node.text = words;
  }
  void constants(Node& root) {
    each_item(found(root, {"constants"}), [this](Node& value) { constant(value); });
    each_item(found(root, {"tasks"}),
              [this](Node& task) { each_item(found(task, {"constants"}), [this](Node& value) { constant(value); }); });
  }
};

void follow_task(Node& root, NameChange& change) {
  each_item(found(root, {"configurations"}), [&](Node& set) {
    Node* members = set.is_map() ? found(set, {"tasks"}) : &set;
    each_item(members, [&](Node& member) { change.scalar(&member); });
  });
  each_item(found(root, {"tasks"}), [&](Node& task) {
    change.scalar(found(task, {"standby_for"}));
    change.scalar(found(task, {"standby_for", "task"}));
  });
  change.constants(root);
}

// A step without a name has that of its configuration, and `else` of other steps names it.
void follow_steps(Node& root, NameChange& change) {
  Node* const steps = steps_of(root);
  bool is_name = false;
  each_item(steps, [&](Node& step) {
    const Node* const name = found(step, {"name"});
    is_name = is_name || (name != nullptr && name->is_scalar() && name->text == change.from);
  });
  each_item(steps, [&](Node& step) {
    change.scalar(found(step, {"switch"}));
    if (!is_name && change.from != "stop") change.scalar(found(step, {"else"}));
  });
}

void follow_configuration(Node& root, NameChange& change) {
  change.scalar(found(root, {"start"}));
  follow_steps(root, change);
  each_item(found(root, {"tasks"}), [&](Node& task) {
    for (const char* key : {"on_miss", "on_overrun", "on_fault"}) change.scalar(found(task, {key, "switch"}));
    change.scalar(found(task, {"on_fault", "then", "switch"}));
  });
  change.constants(root);
}

void follow_rtpu(Node& root, NameChange& change) {
  each_item(found(root, {"tasks"}), [&](Node& task) { change.scalar(found(task, {"rtpu"})); });
}

/// A task without `component` takes it from its name, so the old name is written out.
void keep_component(Node& task, const std::string& name) {
  if (task.is_none()) task.kind = Node::Kind::kMap;
  if (task.is_map() && task.find("component") == nullptr) insert_key(task, 0, "component", scalar_node(name));
}

Result<void> rename_everywhere(Node& root, const RenameKey& act) {
  const std::string& from = act.path.back();
  if (is_variable_named(root, act.to))
    return no_edit(act.path,
                   "'" + act.to + "' is the name of a variable or constant already: link ports to it instead");
  const std::size_t places = rename_variable(root, from, act.to);
  for (const TaskPort& user : act.ports) {
    if (Node* alias = found(root, {"tasks", user.task, "alias", user.port}); alias != nullptr) continue;
    if (auto linked = link_port(root, {user.task, user.port, act.to, std::nullopt}); !linked) return linked;
  }
  if (places == 0 && act.ports.empty()) return no_edit(act.path, "no alias, operator or constant has this name");
  return {};
}

}  // namespace

std::size_t rename_variable(Node& root, const std::string& from, const std::string& to) {
  NameChange change{from, to};
  change.key(found(root, {"operator"}));
  change.key(found(root, {"constants"}));
  each_item(found(root, {"tasks"}), [&](Node& task) {
    each_item(found(task, {"alias"}), [&](Node& variables) { change.scalars(variables); });
  });
  each_item(found(root, {"configurations"}), [&](Node& set) { change.condition(found(set, {"safe_when"})); });
  each_item(steps_of(root), [&](Node& step) { change.condition(found(step, {"until"})); });
  return change.places;
}

bool is_variable_named(Node& root, const std::string& name) {
  bool is_named = found(root, {"operator", name}) != nullptr || found(root, {"constants", name}) != nullptr;
  const auto judge = [&](const Node& node) { is_named = is_named || (node.is_scalar() && node.text == name); };
  each_item(found(root, {"tasks"}), [&](Node& task) {
    each_item(found(task, {"alias"}), [&](Node& variables) {
      judge(variables);
      each_item(&variables, judge);
    });
  });
  return is_named;
}

Result<void> rename_key(Node& root, const RenameKey& act) {
  if (act.path.size() < 2) return no_edit(act.path, "keys of the file have fixed names");
  const std::string& section = act.path[0];
  const std::string& from = act.path.back();
  if (const auto legal = check_new_name(act.path, act.to); !legal) return legal;
  if (from == act.to) return {};
  const bool is_link = section == "operator" || section == "constants" || section == "variables";
  const EditPath above(act.path.begin(), act.path.end() - 1);
  Node* const map = found(root, above);
  if (section != "variables") {
    if (map == nullptr || !map->is_map() || map->find(from) == nullptr)
      return no_edit(act.path, map == nullptr ? "no such key" : no_such("key", from, names_of(map->keys, &Word::text)));
    if (map->find(act.to) != nullptr) return no_edit(act.path, "there is '" + act.to + "' already");
  }
  if (act.path.size() == 2 && is_link) return rename_everywhere(root, act);
  NameChange change{from, act.to};
  if (act.path.size() == 2 && section == "tasks") {
    keep_component(*found(root, act.path), from);
    follow_task(root, change);
  }
  if (act.path.size() == 2 && section == "configurations") follow_configuration(root, change);
  if (act.path.size() == 2 && section == "rtpus") follow_rtpu(root, change);
  change.key(map);
  return {};
}

}  // namespace chimera
