// SPDX-License-Identifier: Apache-2.0
// What `chimera bake` prints about an image: memory, stacks, and what double precision costs.
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
