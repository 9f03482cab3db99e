// SPDX-License-Identifier: Apache-2.0
// Angles of joints that turn without end.
#pragma once

#include "chimera/base/math.h"

namespace chimera::library {

/// `angle`, a difference of two angles in rad; of a continuous joint the short way, from -pi to below pi. Context:
/// cycle; wait-free.
constexpr double short_way(double angle, bool is_continuous) noexcept {
  return is_continuous ? angle - 2 * math::kPi * math::floor(angle / (2 * math::kPi) + 0.5) : angle;
}

}  // namespace chimera::library
