// SPDX-License-Identifier: Apache-2.0
// The limits of the control protocol: docs/formats/control.md, "Limits".
#pragma once

#include <cstddef>

#include "chimera/base/time.h"

namespace chimera::control {

inline constexpr std::size_t kMaxLine = std::size_t{1} << 20;
inline constexpr std::size_t kMaxDepth = 32;
inline constexpr std::size_t kMaxValues = 10'000;  ///< commas: so that no line takes long to read
inline constexpr std::size_t kLongLine = std::size_t{1} << 14;  ///< a longer one counts once for each such piece
inline constexpr int kRequestsPerSecond = 1000, kRequestBurst = 200;
inline constexpr int kActsPerSecond = 100, kActBurst = 50;
inline constexpr std::size_t kMaxConnections = 64, kMaxConnectionsOfUser = 16;
/// Of nobody, observe, operate, configure, root and the user of the subsystem: of all up to that rank together.
inline constexpr std::size_t kPlacesUpTo[] = {0, 32, 40, 48, kMaxConnections};
inline constexpr std::size_t kMaxListenersOfUser = 12;  ///< connections with subscriptions: commands find a place
inline constexpr std::size_t kMaxSubscriptions = 32;
inline constexpr std::size_t kMaxOutput = std::size_t{1} << 20;  ///< beyond it nothing more is read from the peer
inline constexpr Nanoseconds kPatience = seconds(5);  ///< with a peer that takes nothing, or does not end its line
/// Of one turn of the door for questions, and as much for notifications: then acts come first again, and what else the
/// owner of the door does. One question more may be under way.
inline constexpr Nanoseconds kTurn = milliseconds(4);

}  // namespace chimera::control
