// SPDX-License-Identifier: Apache-2.0
// The boxes of a picture from top to bottom: an order of each column in which few lines cross.
#pragma once

#include <vector>

#include "chimera/draw/route.h"

namespace chimera::draw {

/// Orders the boxes of each column, sets their places, and returns the lines between them. The best of several orders
/// counts, by crossings, then by the length of all lines. Requires: sizes and columns are set. Context: setup.
Routes place(std::vector<Placed>& boxes);

}  // namespace chimera::draw
