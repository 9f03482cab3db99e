// SPDX-License-Identifier: Apache-2.0
// Sorts tasks into columns by data flow.
#include <algorithm>
#include <functional>
#include <map>

#include "chimera/draw/layout.h"

namespace chimera::draw {
namespace {

using Edges = std::vector<std::vector<std::size_t>>;  // by box, ascending: numbers of other boxes

/// The boxes that each box feeds.
Edges fed_by(const Graph& graph) {
  std::map<std::string_view, std::vector<std::size_t>> readers;
  for (std::size_t i = 0; i < graph.boxes.size(); ++i)
    for (const Port& port : graph.boxes[i].ports)
      if (port.kind == PortKind::kIn && !port.variable.empty()) readers[port.variable].push_back(i);
  Edges edges(graph.boxes.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    std::vector<std::size_t>& all = edges[i];
    for (const Port& port : graph.boxes[i].ports) {
      if (port.kind != PortKind::kOut) continue;
      const auto found = readers.find(port.variable);
      if (found != readers.end()) all.insert(all.end(), found->second.begin(), found->second.end());
    }
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    std::erase(all, i);
  }
  return edges;
}

/// Forward links: those of a depth-first walk that do not lead back to a box on the present path.
Edges forward_edges(const Graph& graph) {
  const Edges edges = fed_by(graph);
  Edges forward(edges.size());
  std::vector<int> seen(edges.size(), 0);  // 0 not visited, 1 on the path, 2 done
  const std::function<void(std::size_t)> walk = [&](std::size_t i) {
    seen[i] = 1;
    for (const std::size_t k : edges[i]) {
      if (seen[k] == 1) continue;
      forward[i].push_back(k);
      if (seen[k] == 0) walk(k);
    }
    seen[i] = 2;
  };
  std::vector<bool> is_fed(edges.size());
  for (const auto& all : edges)
    for (const std::size_t k : all) is_fed[k] = true;
  // Boxes without inputs from other boxes come first, so that a loop behind them is cut at its entry.
  for (const bool sources : {true, false})
    for (std::size_t i = 0; i < edges.size(); ++i)
      if (seen[i] == 0 && is_fed[i] != sources) walk(i);
  return forward;
}

}  // namespace

std::vector<std::size_t> columns_of(const Graph& graph) {
  const Edges forward = forward_edges(graph);
  std::vector<std::size_t> columns(graph.boxes.size(), 0);
  bool moved = true;
  for (std::size_t round = 0; moved && round <= graph.boxes.size(); ++round) {
    moved = false;
    for (std::size_t i = 0; i < forward.size(); ++i) {
      for (const std::size_t k : forward[i]) {
        if (columns[k] >= columns[i] + 1) continue;
        columns[k] = columns[i] + 1;
        moved = true;
      }
    }
  }
  return columns;
}

}  // namespace chimera::draw
