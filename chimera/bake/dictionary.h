// SPDX-License-Identifier: Apache-2.0
// The names behind the numbers of an image: docs/formats/baked.md.
#pragma once

#include <string>

#include "chimera/bake/application.h"
#include "chimera/bake/target.h"

namespace chimera::bake {

/// The text of dictionary.json, with a line end. Context: setup.
std::string dictionary_text(const BakedApplication& application, const Target& target);

}  // namespace chimera::bake
