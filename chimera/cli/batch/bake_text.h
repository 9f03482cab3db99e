// SPDX-License-Identifier: Apache-2.0
// The report of `chimera bake` about an image: memory, stacks, and the cost of double precision.
#pragma once

#include <string>

#include "chimera/bake/bake.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// A table of the tasks and the sums against the memories of the target. Context: setup.
std::string bake_text(const Configuration& configuration, const bake::Target& target, const bake::BakeResult& result);
/// Sizes, files and faults as an object: docs/formats/baked.md.
Json bake_json(const Configuration& configuration, const bake::Target& target, const bake::BakeResult& result);

}  // namespace chimera::cli
