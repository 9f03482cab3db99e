// SPDX-License-Identifier: Apache-2.0
// The lines of a picture. Each output has a vertical track in the channel right of its column. Inputs in the next
// column branch off there. All other inputs have a track in the channel left of their column, which a lane below all
// boxes joins to the track of the output. Tracks and lanes stand in the order with few crossings.
#pragma once

#include <vector>

#include "chimera/draw/placed.h"

namespace chimera::draw {

/// Lines with their dots, and the place that they take.
struct Routes {
  std::vector<Piece> lines;
  std::vector<Dot> dots;
  int width = 0, height = 0;
};

/// Sets `x` of all boxes and routes the nets between them; lanes begin at `bottom`. Requires: columns and heights are
/// final. Context: setup.
Routes route(std::vector<Placed>& boxes, const std::vector<Net>& nets, const std::vector<Column>& columns, int bottom);

}  // namespace chimera::draw
