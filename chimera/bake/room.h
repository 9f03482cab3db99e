// SPDX-License-Identifier: Apache-2.0
// Room for values in an image: where a constant of the description fixes the extent of a port, the port has exactly
// that room, and not that of the largest extent.
#pragma once

#include "chimera/runtime/application_spec.h"

namespace chimera::bake {

/// Lowers the largest extents of the port or operator variable, of one dimension, to the value of their constant.
/// Context: setup.
void fit(PortSpec& port, const ApplicationSpec& spec) noexcept;
void fit(GivenSpec& given, const ApplicationSpec& spec) noexcept;
/// Drops the elements of a given constant behind the room of every port that is linked to it. Requires: the ports of
/// `spec` are fitted. Context: setup.
void fit(ConstantSpec& constant, ConstantId id, const ApplicationSpec& spec) noexcept;

}  // namespace chimera::bake
