// SPDX-License-Identifier: Apache-2.0
// Sorts tasks into columns by data flow, orders each column by its neighbours, and measures boxes in pixels.
#include "chimera/draw/layout.h"

#include <algorithm>
#include <functional>
#include <set>

#include "chimera/base/hosted/wording.h"
#include "chimera/draw/route.h"

namespace chimera::draw {
namespace {

constexpr int kMargin = 24;
constexpr int kHeadLine = 16;

bool feeds(const Box& from, const Box& to) {
  for (const Port& out : from.ports) {
    if (out.kind != PortKind::kOut || out.variable.empty()) continue;
    for (const Port& in : to.ports) {
      if (in.kind == PortKind::kIn && in.variable == out.variable) return true;
    }
  }
  return false;
}

/// Forward links: those of a depth-first walk that do not lead back to a box on the present path.
std::vector<std::vector<std::size_t>> forward_edges(const Graph& graph) {
  const std::size_t n = graph.boxes.size();
  std::vector<std::vector<std::size_t>> forward(n);
  std::vector<int> seen(n, 0);  // 0 not visited, 1 on the path, 2 done
  const std::function<void(std::size_t)> walk = [&](std::size_t i) {
    seen[i] = 1;
    for (std::size_t k = 0; k < n; ++k) {
      if (k == i || !feeds(graph.boxes[i], graph.boxes[k]) || seen[k] == 1) continue;
      forward[i].push_back(k);
      if (seen[k] == 0) walk(k);
    }
    seen[i] = 2;
  };
  // Boxes without inputs from other boxes come first, so that a loop behind them is cut at its entry.
  for (const bool sources : {true, false}) {
    for (std::size_t i = 0; i < n; ++i) {
      const bool is_fed = std::any_of(graph.boxes.begin(), graph.boxes.end(), [&](const Box& b) {
        return &b != &graph.boxes[i] && feeds(b, graph.boxes[i]);
      });
      if (seen[i] == 0 && is_fed != sources) walk(i);
    }
  }
  return forward;
}

Placed measure(const Graph& graph, std::size_t index) {
  Placed placed;
  placed.box = index;
  int left = 0, right = 0;
  for (const Port& port : graph.boxes[index].ports) {
    if (port.kind == PortKind::kIn) placed.in.push_back(&port), left = std::max(left, width_of(port.name));
    if (port.kind == PortKind::kOut) placed.out.push_back(&port), right = std::max(right, width_of(port.name));
    if (port.kind == PortKind::kInConst || port.kind == PortKind::kOutConst) placed.above.push_back(&port);
    if (port.kind == PortKind::kResource) placed.below.push_back(&port);
  }
  placed.width = std::max(96, left + right + 28);
  const std::vector<std::string> head = head_of(graph.boxes[index]);
  for (const std::string& line : head) placed.width = std::max(placed.width, width_of(line) + 24);
  for (const auto* side : {&placed.above, &placed.below}) {
    for (std::size_t i = 0; i < side->size(); ++i) {
      const int label = width_of((*side)[i]->name) + width_of((*side)[i]->variable) + kLetter * 2;
      placed.width = std::max(placed.width, static_cast<int>(i + 1) * kStep + label);
    }
  }
  const std::size_t rows = std::max(placed.in.size(), placed.out.size());
  placed.height = static_cast<int>(head.size()) * kHeadLine + 24 + static_cast<int>(rows) * kRow;
  return placed;
}

int labels_height(std::size_t count) { return count == 0 ? 0 : static_cast<int>(count) * kStep + 16; }

/// Stacks the boxes of one column, from the top, on the row grid that all columns share.
int stack(std::vector<Placed*>& column, const Graph& graph, int top) {
  int y = top;
  for (Placed* placed : column) {
    const int head = static_cast<int>(head_of(graph.boxes[placed->box]).size()) * kHeadLine + 20;
    y += labels_height(placed->above.size());
    placed->first_row = (y + head + kRow - 1) / kRow * kRow;
    placed->y = placed->first_row - head;
    y = placed->y + placed->height + labels_height(placed->below.size()) + 26;
  }
  return y;
}

/// Orders a column by the mean height of the boxes that feed it.
void order(std::vector<Placed*>& column, const Layout& layout, const Graph& graph) {
  const auto pull = [&](const Placed* placed) {
    int sum = 0, count = 0;
    for (const Placed& other : layout.boxes) {
      if (other.column >= placed->column || !feeds(graph.boxes[other.box], graph.boxes[placed->box])) continue;
      sum += other.y + other.height / 2;
      ++count;
    }
    return count == 0 ? 0 : sum / count;
  };
  std::vector<std::pair<int, Placed*>> pulled;
  pulled.reserve(column.size());
  for (Placed* placed : column) pulled.emplace_back(pull(placed), placed);
  std::stable_sort(pulled.begin(), pulled.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::transform(pulled.begin(), pulled.end(), column.begin(), [](const auto& one) { return one.second; });
}

}  // namespace

std::vector<std::string> head_of(const Box& box) {
  std::vector<std::string> lines{box.name};
  if (!box.component.empty() && box.component != box.name) lines.push_back(box.component);
  std::string state = box.rate;
  if (!box.state.empty()) append_joined(state, " ", box.state);
  if (!state.empty()) lines.push_back(state);
  return lines;
}

std::vector<std::size_t> columns_of(const Graph& graph) {
  const auto forward = forward_edges(graph);
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

Layout lay_out(const Graph& graph) {
  Layout layout;
  const std::vector<std::size_t> columns = columns_of(graph);
  std::size_t n_columns = 0;
  for (std::size_t i = 0; i < graph.boxes.size(); ++i) {
    layout.boxes.push_back(measure(graph, i));
    layout.boxes.back().column = columns[i];
    n_columns = std::max(n_columns, columns[i] + 1);
  }
  std::vector<std::vector<Placed*>> stacks(n_columns);
  for (Placed& placed : layout.boxes) stacks[placed.column].push_back(&placed);
  int bottom = 0;
  for (auto& column : stacks) {
    order(column, layout, graph);
    bottom = std::max(bottom, stack(column, graph, kMargin + 30));
  }
  Router router(layout, n_columns);
  int x = kMargin;
  for (std::size_t c = 0; c < n_columns; ++c) {
    x = router.place_channel(c, x);
    int widest = 0;
    for (Placed* placed : stacks[c]) placed->x = x, widest = std::max(widest, placed->width);
    x += widest;
  }
  layout.width = router.place_channel(n_columns, x) + kMargin;
  layout.height = router.draw(bottom) + kMargin;
  return layout;
}

}  // namespace chimera::draw
