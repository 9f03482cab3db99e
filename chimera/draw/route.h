// SPDX-License-Identifier: Apache-2.0
// The lines of a picture. Each output has a vertical track in the channel right of its column. Inputs in the next
// column branch off there. All other inputs have a track in the channel left of their column, which a lane below all
// boxes joins to the track of the output. Tracks and lanes stand in the order with few crossings.
#pragma once

#include <vector>

#include "chimera/draw/placed.h"

namespace chimera::draw {

/// Lines, and the place that they take.
struct Routes {
  std::vector<Piece> lines;
  int width = 0, height = 0;
};

/// Sets `x` of all boxes and routes the nets between them; lanes begin at `bottom`. Requires: columns and heights are
/// final. Context: setup.
Routes route(std::vector<Placed>& boxes, const std::vector<Net>& nets, const std::vector<Column>& columns, int bottom);

/// A dot for each end of a piece at which its variable goes on in at least three directions. Context: setup.
std::vector<Dot> dots_of(const std::vector<Piece>& lines);

}  // namespace chimera::draw
