// SPDX-License-Identifier: Apache-2.0
// Measures boxes, and places ports, labels, constants and resources around them.
#include "chimera/draw/layout.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/draw/order.h"

namespace chimera::draw {
namespace {

/// The name of a port and, if it differs, its link or its written value.
std::string link_text(const Port& port, const char* between) {
  const std::string& to = port.variable.empty() ? port.written : port.variable;
  return to.empty() || to == port.name ? port.name : port.name + between + to;
}

Placed measure(const Box& box, std::size_t column) {
  Placed placed;
  placed.box = &box;
  placed.column = column;
  placed.head = head_of(box);
  int left = 0, right = 0;
  for (const Port& port : box.ports) {
    if (!port.is_drawn) continue;
    if (port.kind == PortKind::kIn) placed.in.push_back(&port), left = std::max(left, width_of(port.name));
    if (port.kind == PortKind::kOut) placed.out.push_back(&port), right = std::max(right, width_of(port.name));
    if (port.kind == PortKind::kInConst || port.kind == PortKind::kOutConst) placed.above.push_back(&port);
    if (port.kind == PortKind::kResource) placed.below.push_back(&port);
  }
  placed.is_fed.resize(placed.in.size());
  placed.width = std::max(96, left + right + 28);
  for (const std::string& line : placed.head) placed.width = std::max(placed.width, width_of(line) + 24);
  for (const auto* side : {&placed.above, &placed.below})
    for (std::size_t i = 0; i < side->size(); ++i) {
      const int label = width_of(link_text(*(*side)[i], ": "));
      placed.width = std::max(placed.width, static_cast<int>(i + 1) * kStep + 10 + label);
    }
  const std::size_t rows = std::max(placed.in.size(), placed.out.size());
  placed.height = static_cast<int>(placed.head.size()) * kHeadLine + 24 + static_cast<int>(rows) * kRow;
  return placed;
}

/// Adds a box with all that lies in and around it, but for the lines of its inputs and outputs.
class BoxDrawer {
 public:
  BoxDrawer(Layout& layout, const Graph& graph, const Placed& box) : layout_(layout), graph_(graph), p_(box) {}

  void draw() {
    layout_.boxes.push_back({p_.box->name, p_.x, p_.y, p_.width, p_.height});
    for (std::size_t i = 0; i < p_.head.size(); ++i)
      label(p_.head[i], p_.x + p_.width / 2, p_.y + 18 + static_cast<int>(i) * kHeadLine, i == 0 ? "name" : "soft",
            "middle");
    for (std::size_t i = 0; i < p_.in.size(); ++i) draw_input(*p_.in[i], p_.in_y(i), p_.is_fed[i]);
    for (std::size_t i = 0; i < p_.out.size(); ++i) draw_output(*p_.out[i], p_.out_y(i));
    for (std::size_t i = 0; i < p_.above.size(); ++i) draw_above(i);
    for (std::size_t i = 0; i < p_.below.size(); ++i) draw_below(i);
  }

 private:
  void label(std::string text, int x, int y, const char* style, const char* anchor, std::string_view variable = {}) {
    if (!text.empty()) layout_.labels.push_back({std::move(text), x, y, style, anchor, p_.box->name, variable});
  }
  void port(const Port& port, int x, int y) { layout_.ports.push_back({p_.box->name, &port, x, y}); }
  void line(const Port& port, int x, int y1, int y2, const char* arrow) {
    layout_.lines.push_back({port.variable, x, y1, x, y2, arrow});
  }

  void draw_input(const Port& input, int y, bool is_fed) {
    port(input, p_.x, y);
    label(input.name, p_.x + 8, y + 4, "port", "start", input.variable);
    const bool is_given = std::ranges::count(graph_.given, input.variable) > 0;
    if (!is_fed) label(input.variable, p_.x - kStub - 4, y + 4, is_given ? "given" : "soft", "end", input.variable);
  }

  void draw_output(const Port& output, int y) {
    const int right = p_.x + p_.width;
    port(output, right, y);
    label(output.name, right - 8, y + 4, "port", "end", output.variable);
    label(output.variable, right + 4, y - 6, "soft", "start", output.variable);
  }

  /// The leftmost line is the longest, so that its label runs over all others.
  void draw_above(std::size_t i) {
    const Port& constant = *p_.above[i];
    const int x = p_.x + static_cast<int>(i + 1) * kStep;
    const int top = p_.y - 6 - static_cast<int>(p_.above.size() - i) * kStep;
    port(constant, x, p_.y);
    line(constant, x, top, p_.y, constant.kind == PortKind::kInConst ? "end" : "start");
    label(link_text(constant, "="), x + 6, top + 6, "soft", "start", constant.variable);
  }

  void draw_below(std::size_t i) {
    const Port& resource = *p_.below[i];
    const int x = p_.x + static_cast<int>(i + 1) * kStep;
    const int bottom = p_.y + p_.height + 6 + static_cast<int>(p_.below.size() - i) * kStep;
    port(resource, x, p_.y + p_.height);
    line(resource, x, p_.y + p_.height, bottom, "both");
    label(link_text(resource, ": "), x + 6, bottom + 2, "soft", "start");
  }

  Layout& layout_;
  const Graph& graph_;
  const Placed& p_;
};

}  // namespace

std::vector<std::string> head_of(const Box& box) {
  std::vector<std::string> lines{box.name};
  if (!box.component.empty() && box.component != box.name) lines.push_back(box.component);
  std::string state = box.rate;
  if (!box.state.empty()) append_joined(state, " ", box.state);
  if (!state.empty()) lines.push_back(state);
  return lines;
}

Layout lay_out(const Graph& graph) {
  const std::vector<std::size_t> columns = columns_of(graph);
  std::vector<Placed> boxes;
  for (std::size_t i = 0; i < graph.boxes.size(); ++i) boxes.push_back(measure(graph.boxes[i], columns[i]));
  Routes routes = place(boxes);
  Layout layout{graph.title, {}, {}, std::move(routes.lines), {}, {}, 0, routes.height};
  layout.dots = dots_of(layout.lines);
  layout.width = std::max(routes.width, width_of(graph.title) * 3 / 2 + 48);
  if (!graph.title.empty()) layout.labels.push_back({graph.title, 24, 26, "title"});
  for (const Placed& box : boxes) BoxDrawer(layout, graph, box).draw();
  return layout;
}

}  // namespace chimera::draw
