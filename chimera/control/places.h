// SPDX-License-Identifier: Apache-2.0
// Grants places to connections, and picks the one that gives way when none is left: docs/formats/control.md, "Places".
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "chimera/base/time.h"
#include "chimera/control/connection.h"

namespace chimera::control {

/// Activity of a connection. Connections with a lower value give way first.
enum class Activity : unsigned char {
  kHalfLine,  ///< began a line and has not ended it
  kIdle,      ///< nothing at all, or subscriptions that it does not read
  kAsks,      ///< has asked what changes nothing, and is not answered yet
  kListens,   ///< reads what it subscribed to
  kActs,      ///< an act of it is under way: never gives way
};

/// Beyond the roles: root and the user of the subsystem.
enum class Rank : unsigned char { kNone, kObserve, kOperate, kConfigure, kOwner };
Rank rank_of(const PeerIdentity& peer, uid_t owner) noexcept;

struct Occupant {
  std::uint64_t number = 0;
  uid_t user = 0;
  Rank rank = Rank::kObserve;
  Activity activity = Activity::kIdle;
  Nanoseconds since;  ///< of a half line its first byte, else when it last said anything
};

struct PlaceGrant {
  bool is_granted = false;
  std::uint64_t in_place_of = 0;  ///< connection that gives way; 0: none
  std::string refusal;            ///< which places are taken
};

/// A place for one more connection, of `user` and `rank`. If the places of the user or of the rank are taken, another
/// connection gives way. A connection never gives way to a lower rank. A reader of subscriptions gives way only to a
/// higher rank. Connections that do nothing give way first, among them the lowest rank. In one rank half lines come
/// first, then the longest silence. Context: setup.
PlaceGrant find_place(std::span<const Occupant> all, uid_t user, Rank rank);

}  // namespace chimera::control
