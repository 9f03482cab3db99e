// SPDX-License-Identifier: Apache-2.0
// Makes the graph of a configuration: a box a task, a line a variable.
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

/// The value that the file writes for the port; empty for a list; none: the file writes no value.
std::optional<std::string> written_at(const std::vector<NamedNode>& values, const std::string& port) {
  const std::string declared = port.substr(0, port.find('['));
  const auto at = std::ranges::find_if(values, [&](const NamedNode& each) { return each.name.text == declared; });
  if (at == values.end()) return std::nullopt;
  return at->value.is_scalar() ? cut(at->value.text) : "";
}

using Names = std::set<std::string, std::less<>>;

Box box_of(const ConfiguredTask& task, const DraftTask& draft, const Names& read_constants) {
  Box box;
  box.name = task.name;
  box.component = task.component;
  box.rate = rate_text(task.rate_hz);
  for (const ConfiguredPort& port : task.ports) {
    const auto kind = kind_of(port.kind);
    if (!kind) continue;
    const bool is_resource = *kind == PortKind::kResource;
    const auto written = written_at(is_resource ? draft.resources : draft.constants, port.name);
    const bool is_read = *kind != PortKind::kOutConst || read_constants.contains(port.variable);
    const bool is_default = *kind == PortKind::kInConst && port.variable.empty() && !written;
    const bool has_value = is_resource || *kind == PortKind::kInConst;
    box.ports.push_back(
        {*kind, port.name, port.variable, has_value ? written.value_or("") : "", is_read && !is_default});
  }
  return box;
}

}  // namespace

Graph graph_of(const Configuration& configuration, const ConfiguredSet* set) {
  Graph graph;
  graph.title = configuration.subsystem() + (set == nullptr ? "" : ": " + set->name);
  std::vector<const ConfiguredTask*> tasks;
  for (std::size_t t = 0; t < configuration.tasks().size(); ++t)
    if (set == nullptr || std::ranges::count(set->order, TaskId(t)) > 0) tasks.push_back(&configuration.tasks()[t]);
  Names read_constants;
  for (const ConfiguredTask* task : tasks)
    for (const ConfiguredPort& port : task->ports)
      if (port.kind == CHIMERA_IN_CONST && !port.variable.empty()) read_constants.insert(port.variable);
  const std::vector<DraftTask>& drafts = configuration.draft().tasks;
  for (const ConfiguredTask* task : tasks) {
    const auto draft = std::ranges::find(drafts, task->name, [](const DraftTask& each) { return each.name.text; });
    graph.boxes.push_back(box_of(*task, *draft, read_constants));
  }
  for (const ConfiguredVariable& variable : configuration.variables())
    if (variable.is_given) graph.given.push_back(variable.name);
  return graph;
}

}  // namespace chimera::draw
