// SPDX-License-Identifier: Apache-2.0
// The limits of the control protocol: docs/formats/control.md, "Limits".
#pragma once

#include <cstddef>

#include "chimera/base/time.h"

namespace chimera::control {

inline constexpr std::size_t kMaxLine = std::size_t{1} << 20;
inline constexpr std::size_t kMaxDepth = 32;
inline constexpr std::size_t kMaxConnections = 64, kMaxConnectionsOfUser = 16;
inline constexpr std::size_t kMaxSubscriptions = 32;
inline constexpr std::size_t kMaxOutput = std::size_t{1} << 20;  ///< beyond it nothing more is read from the peer
inline constexpr Nanoseconds kPatience = seconds(5);             ///< with a peer that takes nothing

}  // namespace chimera::control
