// SPDX-License-Identifier: Apache-2.0
// Places the lines between the boxes of a picture and writes them as SVG paths.
#include "chimera/draw/route.h"

#include <algorithm>

namespace chimera::draw {

Router::Router(Layout& layout, std::size_t n_columns) : layout_(layout), n_columns_(n_columns) { find_lines(); }

void Router::find_lines() {
  for (const Placed& placed : layout_.boxes) {
    for (std::size_t i = 0; i < placed.out.size(); ++i) {
      Line line;
      line.from = {&placed, i};
      if (!placed.out[i]->variable.empty()) find_inputs(line);
      lines_.push_back(std::move(line));
    }
  }
}

void Router::find_inputs(Line& line) {
  const std::string& variable = line.from.box->out[line.from.port]->variable;
  for (const Placed& placed : layout_.boxes) {
    for (std::size_t i = 0; i < placed.in.size(); ++i) {
      if (placed.in[i]->variable != variable) continue;
      const bool is_near = placed.column == line.from.box->column + 1;
      (is_near ? line.near : line.far).push_back({&placed, i});
    }
  }
  line.far_tracks.resize(line.far.size());
}

int Router::place_channel(std::size_t channel, int x) {
  int labels = 0, stubs = 0;
  for (const Placed& placed : layout_.boxes) {
    if (placed.column + 1 == channel) {
      for (const Port* port : placed.out) labels = std::max(labels, width_of(port->variable) + kLetter);
    }
    if (placed.column == channel) {
      for (const Port* port : placed.in) stubs = std::max(stubs, width_of(port->variable) + kStub);
    }
  }
  x += std::max(labels, channel == 0 ? 0 : kStub);
  for (Line& line : lines_) {
    if (line.is_used() && line.from.box->column + 1 == channel) line.track = x += kStep;
    // Distant inputs of one line in one column share a track.
    int shared = 0;
    for (std::size_t i = 0; i < line.far.size(); ++i) {
      if (line.far[i].box->column != channel) continue;
      if (shared == 0) shared = x += kStep;
      line.far_tracks[i] = shared;
    }
  }
  const bool is_last = channel == n_columns_;
  return x + (is_last ? kStep : std::max(stubs, kStub) + kStep);
}

void Router::piece(int x1, int y1, int x2, int y2, bool has_arrow) {
  if (x1 == x2 && y1 == y2) return;
  layout_.pieces.push_back({x1, y1, x2, y2, false, has_arrow});
}

namespace {

/// A vertical track with branches to the left and right; dots where three lines meet.
struct Track {
  std::vector<int> left, right;

  void add_dots(std::vector<Piece>& pieces, int x, int top, int bottom) const {
    std::vector<int> heights = left;
    heights.insert(heights.end(), right.begin(), right.end());
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    const auto has = [](const std::vector<int>& all, int y) {
      return std::find(all.begin(), all.end(), y) != all.end();
    };
    for (const int y : heights) {
      const int ends = has(left, y) + has(right, y) + (y > top) + (y < bottom);
      if (ends >= 3) pieces.push_back({x, y, x, y, true, false});
    }
  }
};

}  // namespace

void Router::draw_line(const Line& line, int lane) {
  const int y = line.from.box->out_y(line.from.port);
  Track track{.left = {y}, .right = {}};
  piece(line.from.box->x + line.from.box->width, y, line.track, y);
  for (const Pin& pin : line.near) {
    track.right.push_back(pin.box->in_y(pin.port));
    piece(line.track, track.right.back(), pin.box->x, track.right.back(), true);
  }
  if (!line.far.empty()) track.right.push_back(lane);
  const auto [top, bottom] = [&] {
    std::vector<int> all = track.right;
    all.push_back(y);
    return std::pair(*std::min_element(all.begin(), all.end()), *std::max_element(all.begin(), all.end()));
  }();
  piece(line.track, top, line.track, bottom);
  track.add_dots(layout_.pieces, line.track, top, bottom);
  std::vector<int> drops;
  for (std::size_t i = 0; i < line.far.size(); ++i) {
    const int x = line.far_tracks[i], in_y = line.far[i].box->in_y(line.far[i].port);
    piece(x, in_y, line.far[i].box->x, in_y, true);
    if (std::find(drops.begin(), drops.end(), x) != drops.end()) {
      layout_.pieces.push_back({x, in_y, x, in_y, true, false});
      continue;
    }
    drops.push_back(x);
    int highest = in_y;
    for (std::size_t k = i; k < line.far.size(); ++k) {
      if (line.far_tracks[k] == x) highest = std::min(highest, line.far[k].box->in_y(line.far[k].port));
    }
    piece(x, highest, x, lane);
    if (highest < in_y) layout_.pieces.push_back({x, in_y, x, in_y, true, false});
    piece(line.track, lane, x, lane);
  }
}

void Router::draw_stubs() {
  for (const Line& line : lines_) {
    const int x = line.from.box->x + line.from.box->width, y = line.from.box->out_y(line.from.port);
    if (!line.is_used()) piece(x, y, x + kStub, y, true);
  }
  for (const Placed& placed : layout_.boxes) {
    for (std::size_t i = 0; i < placed.in.size(); ++i) {
      const bool is_made = std::any_of(lines_.begin(), lines_.end(), [&](const Line& line) {
        return line.from.box->out[line.from.port]->variable == placed.in[i]->variable;
      });
      if (!is_made) piece(placed.x - kStub, placed.in_y(i), placed.x, placed.in_y(i), true);
    }
  }
}

int Router::draw(int bottom) {
  int lane = bottom;
  for (const Line& line : lines_) {
    if (!line.is_used()) continue;
    draw_line(line, lane);
    if (!line.far.empty()) lane += kStep;
  }
  draw_stubs();
  return lane;
}

}  // namespace chimera::draw
