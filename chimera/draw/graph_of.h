// SPDX-License-Identifier: Apache-2.0
// A configuration as the picture's boxes and lines.
#pragma once

#include "chimera/draw/graph.h"
#include "chimera/verify/configuration.h"

namespace chimera::draw {

/// Every task with its ports, or the tasks of `set` alone; variables that the file or the operator gives are named as
/// such. A constant is drawn if the file writes its value, if it is linked, or if another of the tasks reads it.
/// Context: setup.
Graph graph_of(const Configuration& configuration, const ConfiguredSet* set = nullptr);

}  // namespace chimera::draw
