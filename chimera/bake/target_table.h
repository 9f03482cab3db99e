// SPDX-License-Identifier: Apache-2.0
// The text of the table of the target in tables.cc: docs/formats/baked.md.
#pragma once

#include <string>

#include "chimera/bake/source_text.h"
#include "chimera/bake/target.h"
#include "chimera/runtime/application_spec.h"

namespace chimera::bake {

/// The initialiser of baked::TargetSpec; its lists are added to `all`. Context: setup.
std::string target_table(const ApplicationSpec& spec, const Target& target, Definitions& all);

}  // namespace chimera::bake
