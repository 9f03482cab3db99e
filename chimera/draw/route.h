// SPDX-License-Identifier: Apache-2.0
// The lines of a picture. Each output has a vertical track in the channel right of its column. Inputs in the next
// column branch off there; all other inputs are reached by a lane below all boxes.
#pragma once

#include <cstddef>
#include <vector>

#include "chimera/draw/layout.h"

namespace chimera::draw {

/// Routes lines. Channel c lies left of column c. Call place_channel() for every channel in order, then draw().
/// Context: setup.
class Router {
 public:
  /// Finds the lines between the boxes of `layout`; its columns and heights are final.
  Router(Layout& layout, std::size_t n_columns);

  /// Places the tracks of a channel that begins at `x`; returns its end.
  int place_channel(std::size_t channel, int x);

  /// Adds all pieces to the layout, lanes from `bottom` on; returns the lowest y used.
  int draw(int bottom);

 private:
  struct Pin {
    const Placed* box = nullptr;
    std::size_t port = 0;
  };
  /// One output and the inputs that it feeds.
  struct Line {
    Pin from;
    std::vector<Pin> near;        ///< inputs in the next column
    std::vector<Pin> far;         ///< all others
    int track = 0;                ///< x right of the output
    std::vector<int> far_tracks;  ///< x left of the column of each far input, ordered like `far`
    bool is_used() const noexcept { return !near.empty() || !far.empty(); }
  };
  void find_lines();
  void find_inputs(Line& line);
  void draw_line(const Line& line, int lane);
  void draw_stubs();
  void piece(int x1, int y1, int x2, int y2, bool has_arrow = false);

  Layout& layout_;
  std::size_t n_columns_;
  std::vector<Line> lines_;
};

}  // namespace chimera::draw
