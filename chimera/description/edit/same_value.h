// SPDX-License-Identifier: Apache-2.0
// Values that say the same in other units.
#pragma once

#include "chimera/description/node.h"
#include "chimera/units/unit_system.h"

namespace chimera {

/// True if `now` says what `before` says, in whatever units. A value that is no list fills all elements. Context:
/// setup.
bool says_same(const Node& before, const Node& now, const UnitSystem& units);

/// `now` with the words of `before` in each part that says the same. Context: setup.
Node as_written(const Node& before, Node now, const UnitSystem& units);

}  // namespace chimera
