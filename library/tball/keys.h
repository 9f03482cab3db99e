// SPDX-License-Identifier: Apache-2.0
// Keys in place of a ball: a d, s w, f r along x y z; j l, k i, o u about them; the space bar stops.
#pragma once

#include <optional>

#include "library/tball/ball.h"

namespace chimera::library {

/// Event of full deflection for `key`, or none. Context: cycle; wait-free.
inline std::optional<BallEvent> event_of_key(char key, std::int32_t full) noexcept {
  constexpr char kKeys[kBallAxes][2] = {{'a', 'd'}, {'s', 'w'}, {'f', 'r'}, {'j', 'l'}, {'k', 'i'}, {'o', 'u'}};
  for (std::uint16_t axis = 0; axis < kBallAxes; ++axis) {
    if (key == kKeys[axis][0]) return BallEvent{kRelativeEvent, axis, -full};
    if (key == kKeys[axis][1]) return BallEvent{kRelativeEvent, axis, full};
  }
  return std::nullopt;
}

}  // namespace chimera::library
