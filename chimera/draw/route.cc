// SPDX-License-Identifier: Apache-2.0
// Places tracks and lanes, and makes the pieces and dots of all lines.
#include "chimera/draw/route.h"

#include <algorithm>
#include <climits>
#include <map>
#include <utility>

namespace chimera::draw {
namespace {

constexpr int kMargin = 24;
constexpr std::size_t kPasses = 16;  // enough for 100 tasks; bounds the time for more

/// A vertical part of a net in a channel, with the heights of its branches.
struct Track {
  std::size_t net = 0;
  std::vector<int> left, right;  // y of the output; y of inputs
  bool has_lane = false;         // reaches down to the lane of the net
  int x = 0;

  int top() const { return std::min(least(left), least(right)); }
  int bottom() const { return has_lane ? INT_MAX : std::max(most(left), most(right)); }

 private:
  static int least(const std::vector<int>& all) { return all.empty() ? INT_MAX : *std::ranges::min_element(all); }
  static int most(const std::vector<int>& all) { return all.empty() ? INT_MIN : *std::ranges::max_element(all); }
};

/// Exchanges neighbours as long as that saves crossings. `cost(a, b)`: crossings of a and b if a stands first.
template <class Cost>
void arrange(std::vector<std::size_t>& order, Cost cost) {
  bool moved = true;
  for (std::size_t pass = 0; moved && pass < kPasses; ++pass) {
    moved = false;
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (cost(order[i], order[i - 1]) >= cost(order[i - 1], order[i])) continue;
      std::swap(order[i], order[i - 1]);
      moved = true;
    }
  }
}

std::size_t between(const std::vector<int>& all, int low, int high) {
  return static_cast<std::size_t>(std::ranges::count_if(all, [=](int one) { return low < one && one < high; }));
}

/// Channel c lies left of column c.
class Router {
 public:
  Router(std::vector<Placed>& boxes, const std::vector<Net>& nets, const std::vector<Column>& columns)
      : boxes_(boxes), nets_(nets), columns_(columns), channels_(columns.size() + 1), tracks_of_(nets.size()) {}

  Routes make(int bottom) {
    for (std::size_t n = 0; n < nets_.size(); ++n) add_tracks(n);
    for (auto& channel : channels_)
      arrange(channel, [&](std::size_t a, std::size_t b) {
        const Track &left = tracks_[a], &right = tracks_[b];
        return between(left.right, right.top(), right.bottom()) + between(right.left, left.top(), left.bottom());
      });
    place_columns();
    place_lanes(bottom);
    for (std::size_t n = 0; n < nets_.size(); ++n) draw(n);
    add_inputs_without_net();
    add_dots();
    return std::move(routes_);
  }

 private:
  int out_y(const Net& net) const { return boxes_[net.from.box].out_y(net.from.port); }
  int in_y(const Pin& pin) const { return boxes_[pin.box].in_y(pin.port); }
  std::string_view variable(const Net& net) const { return boxes_[net.from.box].out[net.from.port]->variable; }

  std::size_t add_track(std::size_t net, std::size_t channel) {
    channels_[channel].push_back(tracks_.size());
    tracks_of_[net].push_back(tracks_.size());
    tracks_.push_back({.net = net, .left = {}, .right = {}});
    return tracks_.size() - 1;
  }

  /// The first track of a net is that of its output; then comes one for each column with distant inputs.
  void add_tracks(std::size_t n) {
    const Net& net = nets_[n];
    if (net.to.empty()) return;
    const std::size_t next = boxes_[net.from.box].column + 1, own = add_track(n, next);
    tracks_[own].left = {out_y(net)};
    std::map<std::size_t, std::size_t> of_column{{next, own}};
    for (const Pin& pin : net.to) {
      const std::size_t column = boxes_[pin.box].column;
      if (!of_column.contains(column)) of_column[column] = add_track(n, column);
      tracks_[of_column[column]].right.push_back(in_y(pin));
    }
    if (tracks_of_[n].size() == 1) return;
    for (const std::size_t track : tracks_of_[n]) tracks_[track].has_lane = true;
  }

  void place_columns() {
    int x = kMargin;
    for (std::size_t c = 0; c <= columns_.size(); ++c) {
      x += c == 0 ? 0 : room_right_of(columns_[c - 1]);
      for (const std::size_t track : channels_[c]) tracks_[track].x = x += kStep;
      if (c == columns_.size()) break;
      x += room_left_of(columns_[c]);
      int widest = 0;
      for (const std::size_t box : columns_[c]) {
        boxes_[box].x = x;
        widest = std::max(widest, boxes_[box].width);
      }
      x += widest;
    }
    routes_.width = x + kMargin;
  }

  /// Room for the names and values of outputs.
  int room_right_of(const Column& column) const {
    int room = kStub;
    for (const std::size_t box : column)
      for (const Port* port : boxes_[box].out)
        if (!port->variable.empty()) room = std::max({room, width_of(port->variable) + kLetter, kValueRoom});
    return room;
  }

  /// Room for the names of inputs that no box feeds.
  int room_left_of(const Column& column) const {
    int room = kStub;
    for (const std::size_t box : column)
      for (std::size_t i = 0; i < boxes_[box].in.size(); ++i)
        if (!boxes_[box].is_fed[i]) room = std::max(room, width_of(boxes_[box].in[i]->variable) + kStub);
    return room + kStep;
  }

  std::vector<int> track_places(std::size_t net) const {
    std::vector<int> xs;
    for (const std::size_t track : tracks_of_[net]) xs.push_back(tracks_[track].x);
    std::ranges::sort(xs);
    return xs;
  }

  /// Nets that lie beside each other share a lane.
  void place_lanes(int bottom) {
    std::vector<std::size_t> order;
    std::vector<std::vector<int>> xs(nets_.size());
    for (std::size_t n = 0; n < nets_.size(); ++n) {
      if (tracks_of_[n].size() < 2) continue;
      order.push_back(n);
      xs[n] = track_places(n);
    }
    arrange(order, [&](std::size_t upper, std::size_t lower) {
      return between(xs[lower], xs[upper].front(), xs[upper].back());
    });
    lanes_.resize(nets_.size());
    routes_.height = bottom;
    for (std::size_t i = 0; i < order.size(); ++i) {
      int& lane = lanes_[order[i]] = bottom;
      for (std::size_t k = 0; k < i; ++k) {
        const auto &mine = xs[order[i]], &upper = xs[order[k]];
        if (mine.front() - kStep < upper.back() && upper.front() - kStep < mine.back())
          lane = std::max(lane, lanes_[order[k]] + kStep);
      }
      routes_.height = std::max(routes_.height, lane + kStep);
    }
    routes_.height += kMargin;
  }

  void add(std::string_view variable, int x1, int y1, int x2, int y2, const char* arrow = "") {
    if (x1 != x2 || y1 != y2) routes_.lines.push_back({variable, x1, y1, x2, y2, arrow});
  }

  void draw(std::size_t n) {
    const Net& net = nets_[n];
    const Placed& from = boxes_[net.from.box];
    const int y = out_y(net), right = from.x + from.width;
    if (net.to.empty()) return add(variable(net), right, y, right + kStub, y, "end");
    add(variable(net), right, y, tracks_[tracks_of_[n][0]].x, y);
    for (const std::size_t t : tracks_of_[n]) {
      const Track& track = tracks_[t];
      add(variable(net), track.x, track.top(), track.x, track.has_lane ? lanes_[n] : track.bottom());
    }
    if (const std::vector<int> xs = track_places(n); xs.size() > 1)
      add(variable(net), xs.front(), lanes_[n], xs.back(), lanes_[n]);
    for (const Pin& pin : net.to)
      add(variable(net), track_to(n, pin).x, in_y(pin), boxes_[pin.box].x, in_y(pin), "end");
  }

  /// The track from which the input branches off: the last one left of it.
  const Track& track_to(std::size_t n, const Pin& pin) const {
    const Track* nearest = nullptr;
    for (const std::size_t t : tracks_of_[n])
      if (tracks_[t].x < boxes_[pin.box].x && (nearest == nullptr || nearest->x < tracks_[t].x)) nearest = &tracks_[t];
    return *nearest;
  }

  void add_inputs_without_net() {
    for (const Placed& box : boxes_)
      for (std::size_t i = 0; i < box.in.size(); ++i)
        if (!box.is_fed[i]) add(box.in[i]->variable, box.x - kStub, box.in_y(i), box.x, box.in_y(i), "end");
  }

  /// A dot marks each end of a piece at which its variable goes on in at least three directions.
  void add_dots() {
    std::map<std::string_view, std::vector<const Piece*>> by_variable;
    for (const Piece& piece : routes_.lines) by_variable[piece.variable].push_back(&piece);
    for (const auto& [variable, pieces] : by_variable) {
      std::vector<std::pair<int, int>> ends;
      for (const Piece* piece : pieces) {
        ends.emplace_back(piece->x1, piece->y1);
        ends.emplace_back(piece->x2, piece->y2);
      }
      std::ranges::sort(ends);
      ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
      for (const auto& [x, y] : ends)
        if (directions(pieces, x, y) >= 3) routes_.dots.push_back({variable, x, y});
    }
  }

  static int directions(const std::vector<const Piece*>& pieces, int x, int y) {
    bool left = false, right = false, up = false, down = false;
    for (const Piece* piece : pieces) {
      const auto [x1, x2] = std::minmax(piece->x1, piece->x2);
      const auto [y1, y2] = std::minmax(piece->y1, piece->y2);
      if (x < x1 || x > x2 || y < y1 || y > y2) continue;
      left |= x1 < x;
      right |= x < x2;
      up |= y1 < y;
      down |= y < y2;
    }
    return left + right + up + down;
  }

  std::vector<Placed>& boxes_;
  const std::vector<Net>& nets_;
  const std::vector<Column>& columns_;
  std::vector<Track> tracks_;
  std::vector<std::vector<std::size_t>> channels_;   // tracks from left to right
  std::vector<std::vector<std::size_t>> tracks_of_;  // by net
  std::vector<int> lanes_;                           // y, by net
  Routes routes_;
};

}  // namespace

Routes route(std::vector<Placed>& boxes, const std::vector<Net>& nets, const std::vector<Column>& columns, int bottom) {
  return Router(boxes, nets, columns).make(bottom);
}

std::size_t crossings(const std::vector<Piece>& lines) {
  std::vector<const Piece*> level, upright;
  for (const Piece& piece : lines) (piece.y1 == piece.y2 ? level : upright).push_back(&piece);
  std::ranges::sort(level, {}, [](const Piece* piece) { return piece->y1; });
  std::size_t count = 0;
  for (const Piece* one : upright) {
    const auto [top, bottom] = std::minmax(one->y1, one->y2);
    auto at = std::ranges::upper_bound(level, top, {}, [](const Piece* piece) { return piece->y1; });
    for (; at != level.end() && (*at)->y1 < bottom; ++at) {
      const auto [left, right] = std::minmax((*at)->x1, (*at)->x2);
      count += left < one->x1 && one->x1 < right && (*at)->variable != one->variable ? 1 : 0;
    }
  }
  return count;
}

}  // namespace chimera::draw
