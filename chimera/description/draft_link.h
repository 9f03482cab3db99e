// SPDX-License-Identifier: Apache-2.0
// Reads the keys of an rtpu that is a board.
#pragma once

#include "chimera/description/draft.h"

namespace chimera {

/// Reads `target` and `link` of an rtpu with a map. Context: setup.
void read_board(const Node& map, DraftRtpu& rtpu, Report& report);

}  // namespace chimera
