// SPDX-License-Identifier: Apache-2.0
// Orders each column by the heights of its neighbours, forward and back, and keeps the best of these orders.
#include "chimera/draw/order.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>

namespace chimera::draw {
namespace {

constexpr int kSweeps = 9;               // odd: the first goes forward
constexpr std::size_t kManyPins = 2000;  // with more, one sweep must do: several would take 0.1 s
constexpr int kTop = 54;                 // below the title

std::vector<Net> nets_of(std::vector<Placed>& boxes) {
  std::map<std::string_view, std::vector<Pin>> readers;
  for (std::size_t b = 0; b < boxes.size(); ++b)
    for (std::size_t i = 0; i < boxes[b].in.size(); ++i)
      if (!boxes[b].in[i]->variable.empty()) readers[boxes[b].in[i]->variable].push_back({b, i});
  std::vector<Net> nets;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    for (std::size_t i = 0; i < boxes[b].out.size(); ++i) {
      const auto found = readers.find(boxes[b].out[i]->variable);
      nets.push_back({{b, i}, found == readers.end() ? std::vector<Pin>() : found->second});
      for (const Pin& pin : nets.back().to) boxes[pin.box].is_fed[pin.port] = true;
    }
  }
  return nets;
}

int labels_height(std::size_t count) { return count == 0 ? 0 : static_cast<int>(count) * kStep + 16; }

/// Stacks the boxes of a column from the top, on the grid of rows that all columns share. Returns its lower end.
int stack(std::vector<Placed>& boxes, const Column& column) {
  int y = kTop;
  for (const std::size_t b : column) {
    Placed& box = boxes[b];
    const int head = static_cast<int>(box.head.size()) * kHeadLine + 20;
    y += labels_height(box.above.size());
    box.first_row = (y + head + kRow - 1) / kRow * kRow;
    box.y = box.first_row - head;
    y = box.y + box.height + labels_height(box.below.size()) + 26;
  }
  return y;
}

/// A line between neighbouring columns: the rows of its ends below the first row of their boxes.
struct NearLine {
  std::size_t from = 0, to = 0;
  int out_row = 0, in_row = 0;
};

class Order {
 public:
  explicit Order(std::vector<Placed>& boxes) : boxes_(boxes), nets_(nets_of(boxes)) {
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      if (columns_.size() <= boxes[b].column) columns_.resize(boxes[b].column + 1);
      columns_[boxes[b].column].push_back(b);
    }
    for (const Net& net : nets_) {
      n_pins_ += 1 + net.to.size();
      for (const Pin& pin : net.to)
        if (boxes[pin.box].column == boxes[net.from.box].column + 1)
          near_.push_back({net.from.box, pin.box, static_cast<int>(net.from.port) * kRow + kRow / 2,
                            static_cast<int>(pin.port) * kRow});
    }
  }

  Routes best() {
    for (const Column& column : columns_) stack(boxes_, column);
    for (int n = n_pins_ <= kManyPins ? kSweeps : 1; n > 0; --n) {
      sweep(n % 2 == 1);
      keep_if_better();
    }
    boxes_ = std::move(best_boxes_);
    return std::move(best_);
  }

 private:
  /// Sorts each column by the heights that its boxes would have if the lines from the column before were straight. A
  /// sweep back takes the column behind.
  void sweep(bool is_forward) {
    std::vector<long> sum(boxes_.size()), count(boxes_.size());
    for (std::size_t i = 1; i < columns_.size(); ++i) {
      Column& column = columns_[is_forward ? i : columns_.size() - 1 - i];
      for (const std::size_t b : column) sum[b] = count[b] = 0;
      const std::size_t number = boxes_[column[0]].column;
      for (const NearLine& line : near_) {
        const std::size_t mine = is_forward ? line.to : line.from, other = is_forward ? line.from : line.to;
        if (boxes_[mine].column != number) continue;
        sum[mine] += boxes_[other].first_row + (is_forward ? line.out_row - line.in_row : line.in_row - line.out_row);
        ++count[mine];
      }
      const auto wanted = [&](std::size_t b) { return count[b] == 0 ? boxes_[b].first_row : sum[b] / count[b]; };
      std::ranges::stable_sort(column, {}, wanted);
      stack(boxes_, column);
    }
  }

  void keep_if_better() {
    int bottom = 0;
    for (const Column& column : columns_) bottom = std::max(bottom, stack(boxes_, column));
    Routes routes = route(boxes_, nets_, columns_, bottom);
    long length = 0;
    for (const Piece& piece : routes.lines) length += std::abs(piece.x1 - piece.x2) + std::abs(piece.y1 - piece.y2);
    const std::pair cost(n_pins_ <= kManyPins ? crossings(routes.lines) : 0, length);
    if (!best_boxes_.empty() && cost >= best_cost_) return;
    best_cost_ = cost;
    best_ = std::move(routes);
    best_boxes_ = boxes_;
  }

  std::vector<Placed>& boxes_;
  std::vector<Net> nets_;
  std::vector<Column> columns_;
  std::vector<NearLine> near_;
  std::size_t n_pins_ = 0;
  Routes best_;
  std::vector<Placed> best_boxes_;
  std::pair<std::size_t, long> best_cost_;
};

}  // namespace

Routes place(std::vector<Placed>& boxes) { return Order(boxes).best(); }

}  // namespace chimera::draw
