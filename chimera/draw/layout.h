// SPDX-License-Identifier: Apache-2.0
// Computes the places in a picture. Boxes form columns by data flow, with one vertical track per line between columns.
// Each line that goes back or over a column has a horizontal lane below all boxes. Lengths in pixels.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chimera/draw/graph.h"

namespace chimera::draw {

inline constexpr int kRow = 22;       ///< distance of ports of one side
inline constexpr int kStep = 14;      ///< distance of tracks, lanes and staggered labels
inline constexpr int kLetter = 7;     ///< width reserved for a letter
inline constexpr int kStub = 16;      ///< length of a line without a target

inline int width_of(const std::string& text) { return static_cast<int>(text.size()) * kLetter; }

/// A box and its ports in their order on each side.
struct Placed {
  std::size_t box = 0;
  std::size_t column = 0;
  int x = 0, y = 0, width = 0, height = 0;
  int first_row = 0;  ///< y of the first input; outputs lie half a row lower, so lines never lie on each other
  std::vector<const Port*> in, out, above, below;

  int in_y(std::size_t i) const noexcept { return first_row + static_cast<int>(i) * kRow; }
  int out_y(std::size_t i) const noexcept { return in_y(i) + kRow / 2; }
};

/// A straight piece of a line, or a dot where three meet (both ends equal).
struct Piece {
  int x1 = 0, y1 = 0, x2 = 0, y2 = 0;
  bool is_dot = false;
  bool has_arrow = false;  ///< at its end
};

struct Layout {
  std::vector<Placed> boxes;
  std::vector<Piece> pieces;
  int width = 0, height = 0;
};

/// The layers of `graph`: a box lies right of all boxes that feed it, except over lines that close a loop. Context:
/// setup.
std::vector<std::size_t> columns_of(const Graph& graph);

/// Computes a layout. Requires: the graph outlives it. Context: setup.
Layout lay_out(const Graph& graph);

/// The lines of text inside a box: name, component if it differs, rate and state.
std::vector<std::string> head_of(const Box& box);

}  // namespace chimera::draw
