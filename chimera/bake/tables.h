// SPDX-License-Identifier: Apache-2.0
// The text of tables.cc: docs/formats/baked.md.
#pragma once

#include <string>

#include "chimera/bake/target.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/executive/baked.h"

namespace chimera::bake {

/// Requires: a target that suits the application. Equal arguments give equal texts. Context: setup.
std::string tables_text(const ApplicationSpec& spec, const baked::Run& run, const Target& target);

}  // namespace chimera::bake
