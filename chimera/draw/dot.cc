// SPDX-License-Identifier: Apache-2.0
// Writes a graph of tasks in the language of Graphviz.
#include <map>

#include "chimera/base/hosted/wording.h"
#include "chimera/draw/graph.h"

namespace chimera::draw {
namespace {

std::string label(const Box& box) {
  std::string all = box.name;
  if (!box.component.empty() && box.component != box.name) all += "\n" + box.component;
  if (!box.rate.empty()) all += "\n" + box.rate;
  if (!box.state.empty()) all += "\n" + box.state;
  return backslashed(all);
}

bool is_output(PortKind kind) { return kind == PortKind::kOut || kind == PortKind::kOutConst; }
bool is_constant(PortKind kind) { return kind == PortKind::kInConst || kind == PortKind::kOutConst; }

/// The producers and readers of one variable, as node names.
struct VariableLine {
  std::vector<std::string> from, to;
  bool is_constant = false;
};

std::map<std::string, VariableLine> lines_of(const Graph& graph) {
  std::map<std::string, VariableLine> lines;
  for (const Box& box : graph.boxes) {
    for (const Port& port : box.ports) {
      if (port.kind == PortKind::kResource || port.variable.empty() || !port.is_drawn) continue;
      VariableLine& line = lines[port.variable];
      (is_output(port.kind) ? line.from : line.to).push_back(backslashed(box.name));
      line.is_constant = is_constant(port.kind);
    }
  }
  return lines;
}

void append_line(std::string& out, const std::string& variable, const VariableLine& line) {
  const std::string style = line.is_constant ? ", style=dashed" : "";
  const std::string name = backslashed("var " + variable);
  if (line.from.size() == 1 && line.to.size() == 1) {
    out += "  " + line.from[0] + " -> " + line.to[0] + " [label=" + backslashed(variable) + style + "];\n";
    return;
  }
  // A dot where the line branches, or an open end if the variable has no writer or no reader.
  out += "  " + name + " [shape=point, xlabel=" + backslashed(variable) + "];\n";
  for (const std::string& from : line.from) out += "  " + from + " -> " + name + " [arrowhead=none" + style + "];\n";
  for (const std::string& to : line.to) {
    out += "  " + name + " -> " + to + (line.is_constant ? " [style=dashed];\n" : ";\n");
  }
}

}  // namespace

std::string dot(const Graph& graph) {
  std::string out = "digraph " + backslashed(graph.title) + " {\n  rankdir=LR;\n  node [shape=box, style=rounded];\n";
  for (const Box& box : graph.boxes) {
    out += "  " + backslashed(box.name) + " [label=" + label(box) + "];\n";
    for (const Port& port : box.ports) {
      if (port.kind != PortKind::kResource) continue;
      const std::string node = backslashed(box.name + " resource " + port.name);
      out += "  " + node + " [shape=plaintext, label=" + backslashed(port.written) + "];\n";
      out += "  " + backslashed(box.name) + " -> " + node +
             " [dir=both, constraint=false, label=" + backslashed(port.name) + "];\n";
    }
  }
  for (const auto& [variable, line] : lines_of(graph)) append_line(out, variable, line);
  return out + "}\n";
}

}  // namespace chimera::draw
