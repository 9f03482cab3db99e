// SPDX-License-Identifier: Apache-2.0
// Makes the graph of a configuration or an outline: a box a task, a line a variable.
#include "chimera/draw/graph_of.h"

#include <algorithm>
#include <optional>
#include <set>

#include "chimera/base/hosted/wording.h"

namespace chimera::draw {
namespace {

constexpr std::size_t kLongest = 24;  // letters of a written value: a longer one would widen the box too much

std::string rate_text(double hz) {
  return hz >= 1000 ? formatted("%g kHz", hz / 1000) : formatted("%g Hz", hz);
}

std::optional<PortKind> kind_of(std::uint32_t kind) {
  switch (kind) {
    case CHIMERA_IN_VAR: return PortKind::kIn;
    case CHIMERA_OUT_VAR: return PortKind::kOut;
    case CHIMERA_IN_CONST: return PortKind::kInConst;
    case CHIMERA_OUT_CONST: return PortKind::kOutConst;
    case CHIMERA_RESOURCE: return PortKind::kResource;
    default: return std::nullopt;  // streams are refused by verification
  }
}

/// `text`, or of a longer one its beginning; of a path its end.
std::string cut(const std::string& text) {
  if (text.size() <= kLongest) return text;
  const bool is_path = text.find('/') != std::string::npos;
  return is_path ? ".." + text.substr(text.size() - kLongest + 2) : text.substr(0, kLongest - 2) + "..";
}

/// The value that the file writes for a port; a null pointer: none.
const Node* written_for(const Configuration& configuration, const ConfiguredTask& task, const ConfiguredPort& port) {
  const std::vector<DraftTask>& drafts = configuration.draft().tasks;
  const auto draft = std::ranges::find(drafts, task.name, [](const DraftTask& each) { return each.name.text; });
  const std::vector<NamedNode>& values = port.kind == CHIMERA_RESOURCE ? draft->resources : draft->constants;
  const std::string declared = port.name.substr(0, port.name.find('['));
  const auto at = std::ranges::find(values, declared, [](const NamedNode& each) { return each.name.text; });
  return at == values.end() ? nullptr : &at->value;
}

const Node* written_for(const Outline&, const OutlineTask&, const OutlinePort& port) {
  static const Node kList;
  return port.own.is_none() ? nullptr : port.is_own_item ? &kList : &port.own;
}

/// True if the port has no value of its own to fall back on.
bool needs_value(const ConfiguredPort&) { return false; }  // a configuration has all values
bool needs_value(const OutlinePort& port) { return port.preset.empty(); }

using Names = std::set<std::string, std::less<>>;

template <class Whole, class Task>
Box box_of(const Whole& whole, const Task& task, const Names& read_constants) {
  Box box;
  box.name = task.name;
  box.component = task.component;
  box.rate = task.rate_hz > 0 ? rate_text(task.rate_hz) : "";
  for (const auto& port : task.ports) {
    const auto kind = kind_of(port.kind);
    if (!kind) continue;
    const bool has_value = *kind == PortKind::kResource || *kind == PortKind::kInConst;
    const Node* written = has_value ? written_for(whole, task, port) : nullptr;
    const bool is_read = *kind != PortKind::kOutConst || read_constants.contains(port.variable);
    const bool is_default = *kind == PortKind::kInConst && port.variable.empty() && written == nullptr &&
                            !needs_value(port);
    box.ports.push_back({*kind, port.name, port.variable,
                         written != nullptr && written->is_scalar() ? cut(written->text) : "", is_read && !is_default});
  }
  return box;
}

/// Adds these tasks of a configuration or an outline.
template <class Whole, class Tasks>
void add_boxes(Graph& graph, const Whole& whole, const Tasks& tasks) {
  Names read_constants;
  for (const auto* task : tasks)
    for (const auto& port : task->ports)
      if (port.kind == CHIMERA_IN_CONST && !port.variable.empty()) read_constants.insert(port.variable);
  for (const auto* task : tasks) graph.boxes.push_back(box_of(whole, *task, read_constants));
}

}  // namespace

Graph graph_of(const Configuration& configuration, const ConfiguredSet* set) {
  Graph graph;
  graph.title = configuration.subsystem() + (set == nullptr ? "" : ": " + set->name);
  std::vector<const ConfiguredTask*> tasks;
  for (std::size_t t = 0; t < configuration.tasks().size(); ++t)
    if (set == nullptr || std::ranges::count(set->order, TaskId(t)) > 0) tasks.push_back(&configuration.tasks()[t]);
  add_boxes(graph, configuration, tasks);
  for (const ConfiguredVariable& variable : configuration.variables())
    if (variable.is_given) graph.given.push_back(variable.name);
  return graph;
}

Graph graph_of(const Outline& outline) {
  Graph graph;
  graph.title = outline.subsystem;
  std::vector<const OutlineTask*> tasks;
  for (const OutlineTask& task : outline.tasks) tasks.push_back(&task);
  add_boxes(graph, outline, tasks);
  for (const OutlineVariable& variable : outline.variables)
    if (variable.origin == Origin::kOperator || variable.origin == Origin::kConstants)
      graph.given.push_back(variable.name);
  return graph;
}

}  // namespace chimera::draw
