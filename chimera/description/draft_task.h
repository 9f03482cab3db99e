// SPDX-License-Identifier: Apache-2.0
// The keys of one task (docs/formats/description.md, "tasks").
#pragma once

#include <optional>

#include "chimera/description/draft.h"

namespace chimera {

/// Reads `name: node` of `tasks`; what cannot be read is left out and stands in `report`. Context: setup.
DraftTask read_task(const Word& name, const Node& node, Report& report);

/// A map name -> anything, as pairs; keys have to be names. Context: setup.
std::vector<NamedNode> read_named(const Node& node, const std::string& what, Report& report);

}  // namespace chimera
