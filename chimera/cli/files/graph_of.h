// SPDX-License-Identifier: Apache-2.0
// A configuration as the picture's boxes and lines.
#pragma once

#include "chimera/draw/graph.h"
#include "chimera/verify/configuration.h"

namespace chimera::cli {

/// Every task with its ports; variables that the file or the operator gives are named as such. Context: setup.
draw::Graph graph_of(const Configuration& configuration);

}  // namespace chimera::cli
