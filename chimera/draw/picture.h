// SPDX-License-Identifier: Apache-2.0
// The layout of a graph as the page reads it: docs/formats/web.md, "The picture".
#pragma once

#include "chimera/draw/graph.h"
#include "chimera/text/json.h"

namespace chimera::draw {

/// Context: setup.
Json picture_json(const Graph& graph);

}  // namespace chimera::draw
