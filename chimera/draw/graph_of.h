// SPDX-License-Identifier: Apache-2.0
// A configuration or an outline as the picture's boxes and lines.
#pragma once

#include "chimera/draw/graph.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/outline.h"

namespace chimera::draw {

/// Every task with its ports, or the tasks of `set` alone; variables that the file or the operator gives are named as
/// such. A constant is drawn if the file writes its value, if it is linked, or if another of the tasks reads it.
/// Context: setup.
Graph graph_of(const Configuration& configuration, const ConfiguredSet* set = nullptr);

/// Every task. A port that a fault parts from its variable is drawn at that variable, and a task of an unknown
/// component has no ports. Of a legal text it is the graph of its configuration. Context: setup.
Graph graph_of(const Outline& outline);

}  // namespace chimera::draw
