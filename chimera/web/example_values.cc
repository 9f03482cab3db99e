// SPDX-License-Identifier: Apache-2.0
// Finds values for a port in the trees of descriptions: those of the task itself, then those of the variable to which
// the port is joined.
#include "chimera/web/example_values.h"

#include <algorithm>

#include "chimera/description/yaml_reader.h"
#include "chimera/description/yaml_words.h"

namespace chimera::web {
namespace {

const Node* at(const Node* map, std::string_view key) { return map == nullptr ? nullptr : map->find(key); }

/// Calls visit(task) for each task that has the component: by its key `component`, or by its name without that key.
void for_each_task(const Node& tree, std::string_view component, const auto& visit) {
  const Node* tasks = tree.find("tasks");
  if (tasks == nullptr || !tasks->is_map()) return;
  for (std::size_t i = 0; i < tasks->keys.size(); ++i) {
    const Node* named = tasks->items[i].find("component");
    if ((named != nullptr ? named->text : tasks->keys[i].text) == component) visit(tasks->items[i]);
  }
}

/// The variable of the port; "" for several, as of a repeated port.
std::string_view variable_of(const Node& task, std::string_view port) {
  const Node* alias = at(task.find("alias"), port);
  if (alias == nullptr) return port;
  return alias->is_scalar() ? std::string_view(alias->text) : std::string_view();
}

/// The value that the description gives to that port of the task; nullptr: none.
const Node* value_of(const Node& tree, const Node& task, std::string_view port) {
  for (const char* section : {"constants", "initial", "resources"})
    if (const Node* own = at(task.find(section), port)) return own;
  for (const char* section : {"constants", "operator"})
    if (const Node* given = at(tree.find(section), variable_of(task, port))) return given;
  return nullptr;
}

}  // namespace

Example example_of(std::string name, std::string_view text) {
  Report unread;
  return {std::move(name), read_yaml(text, unread).value_or(Node{})};
}

std::vector<Example> read_examples(const Documents& documents) {
  std::vector<Example> examples;
  for (const std::string& name : documents.names()) {
    if (!name.starts_with("examples/") || !name.ends_with(".yaml") || std::count(name.begin(), name.end(), '/') != 2)
      continue;
    const auto text = documents.read(name);
    if (text && text->size() <= kMaxTextBytes) examples.push_back(example_of(name, *text));
  }
  return examples;
}

bool uses(const Example& example, std::string_view component) {
  bool is_used = false;
  for_each_task(example.tree, component, [&](const Node&) { is_used = true; });
  return is_used;
}

void add_values(const Example& example, std::string_view component, std::string_view port, std::size_t most,
                std::vector<OfferedValue>& values) {
  for_each_task(example.tree, component, [&](const Node& task) {
    const Node* node = value_of(example.tree, task, port);
    if (node == nullptr || values.size() >= most) return;
    std::string value = written_text(*node);
    const auto is_same = [&](const OfferedValue& one) { return one.value == value; };
    if (std::none_of(values.begin(), values.end(), is_same)) values.push_back({std::move(value), example.name});
  });
}

}  // namespace chimera::web
