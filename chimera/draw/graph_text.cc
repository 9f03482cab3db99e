// SPDX-License-Identifier: Apache-2.0
// Writes a graph of tasks as plain text: each task a box with its inputs on the left and its outputs on the right.
#include <algorithm>
#include <numeric>

#include "chimera/base/hosted/wording.h"
#include "chimera/draw/graph.h"
#include "chimera/draw/layout.h"

namespace chimera::draw {
namespace {

constexpr std::size_t kSide = 32;   // columns left of a box
constexpr std::size_t kInner = 24;  // columns inside a box
constexpr std::size_t kRight = 34;

std::string cut(const std::string& text, std::size_t columns) {
  return text.size() <= columns ? text : text.substr(0, columns - 2) + "..";
}
std::string left(const std::string& text, std::size_t columns) {
  const std::string shown = cut(text, columns);
  return shown + std::string(columns - shown.size(), ' ');
}
std::string right(const std::string& text, std::size_t columns) {
  const std::string shown = cut(text, columns);
  return std::string(columns - shown.size(), ' ') + shown;
}
std::string bar(std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += "\u2500";
  return all;
}

/// The boxes with a port of `kind` for `variable`.
std::string others(const Graph& graph, PortKind kind, const std::string& variable) {
  std::string names;
  for (const Box& box : graph.boxes) {
    for (const Port& port : box.ports) {
      if (port.kind == kind && port.variable == variable) append_joined(names, ", ", box.name);
    }
  }
  return names;
}

std::string input_text(const Graph& graph, const Port& port) {
  const bool is_given = std::find(graph.given.begin(), graph.given.end(), port.variable) != graph.given.end();
  const std::string from = others(graph, PortKind::kOut, port.variable);
  return port.variable + (from.empty() ? (is_given ? " (given)" : " (none)") : " (" + from + ")");
}

std::string output_text(const Graph& graph, const Port& port) {
  const std::string to = others(graph, PortKind::kIn, port.variable);
  return port.variable + (to.empty() ? "" : " (" + to + ")");
}

std::string link_text(const Port& port) {
  const bool has_other = !port.variable.empty() && port.variable != port.name;
  return cut(has_other ? port.name + " = " + port.variable : port.name, kInner + kRight);
}

void append_sides(std::string& out, const Graph& graph, const Box& box) {
  std::vector<const Port*> ins, outs;
  for (const Port& port : box.ports) {
    if (port.kind == PortKind::kIn) ins.push_back(&port);
    if (port.kind == PortKind::kOut) outs.push_back(&port);
  }
  const std::vector<std::string> head = head_of(box);
  const std::size_t rows = std::max({ins.size(), outs.size(), head.size()});
  for (std::size_t i = 0; i < rows; ++i) {
    out += right(i < ins.size() ? input_text(graph, *ins[i]) : "", kSide);
    out += i < ins.size() ? " \u2500\u25b6\u2502 " : "   \u2502 ";
    out += left(i < head.size() ? head[i] : "", kInner) + " \u2502";
    if (i < outs.size()) out += "\u2500\u25b6 " + cut(output_text(graph, *outs[i]), kRight);
    out += "\n";
  }
}

void append_box(std::string& out, const Graph& graph, const Box& box) {
  const std::string indent(kSide + 3, ' ');
  for (const Port& port : box.ports) {
    if (port.kind == PortKind::kInConst) out += indent + "  " + link_text(port) + " \u25bc\n";
    if (port.kind == PortKind::kOutConst) out += indent + "  " + link_text(port) + " \u25b2\n";
  }
  out += indent + "\u256d" + bar(kInner + 2) + "\u256e\n";
  append_sides(out, graph, box);
  out += indent + "\u2570" + bar(kInner + 2) + "\u256f\n";
  for (const Port& port : box.ports) {
    if (port.kind == PortKind::kResource) out += indent + "  \u2195 " + link_text(port) + "\n";
  }
}

}  // namespace

std::string text(const Graph& graph) {
  const std::vector<std::size_t> columns = columns_of(graph);
  std::vector<std::size_t> order(graph.boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return columns[a] < columns[b]; });
  std::string out = graph.title + "\n";
  for (const std::size_t i : order) append_box(out, graph, graph.boxes[i]);
  return out;
}

}  // namespace chimera::draw
