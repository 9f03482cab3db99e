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
/// Connections allowed for all ranks up to this one together. Index: 0 no role, 1 observe, 2 operate, 3 configure,
/// 4 root and the user of the subsystem.
inline constexpr std::size_t kPlacesUpTo[] = {0, 32, 40, 48, kMaxConnections};
inline constexpr std::size_t kMaxListenersOfUser = 12;  ///< connections with subscriptions: commands find a place
inline constexpr std::size_t kMaxSubscriptions = 32;
inline constexpr std::size_t kMaxOutput = std::size_t{1} << 20;  ///< beyond it nothing more is read from the peer
/// A connection is closed if its peer reads nothing, or leaves a line without its end, for this time. Programs write a
/// line at once, and a slow network needs less.
inline constexpr Nanoseconds kStalledPeerLimit = seconds(5);
/// Length of one turn of ControlServer for questions, and of one for notifications. After it acts come first again, and
/// the other work of the loop. One more question may be under way.
inline constexpr Nanoseconds kTurn = milliseconds(4);

}  // namespace chimera::control
