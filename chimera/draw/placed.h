// SPDX-License-Identifier: Apache-2.0
// Boxes on their way into a picture, and the lines between them.
#pragma once

#include <cstddef>
#include <vector>

#include "chimera/draw/layout.h"

namespace chimera::draw {

inline constexpr int kRow = 26;   ///< distance of ports of one side: room for a name above and a value below a line
inline constexpr int kStep = 14;  ///< distance of tracks, lanes and staggered labels
inline constexpr int kStub = 16;  ///< length of a line without a target
inline constexpr int kHeadLine = 16;

/// A box and its ports in their order on each side.
struct Placed {
  const Box* box = nullptr;
  std::vector<std::string> head;
  std::size_t column = 0;
  int x = 0, y = 0, width = 0, height = 0;
  int first_row = 0;  ///< y of the first input; outputs lie half a row lower, so lines never lie on each other
  std::vector<const Port*> in, out, above, below;
  std::vector<bool> is_fed;  ///< by `in`: an output of the graph feeds it

  int in_y(std::size_t i) const noexcept { return first_row + static_cast<int>(i) * kRow; }
  int out_y(std::size_t i) const noexcept { return in_y(i) + kRow / 2; }
};

/// Port number `port` of one side of box number `box`.
struct Pin {
  std::size_t box = 0, port = 0;
};

/// An output and the inputs that it feeds.
struct Net {
  Pin from;
  std::vector<Pin> to;
};

/// A column, from the top: numbers of boxes.
using Column = std::vector<std::size_t>;

}  // namespace chimera::draw
