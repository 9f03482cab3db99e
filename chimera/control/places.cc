// SPDX-License-Identifier: Apache-2.0
// Ranks the connections of a subsystem and chooses which gives way to a new one.
#include "chimera/control/places.h"

#include <algorithm>
#include <tuple>

#include "chimera/control/limits.h"

namespace chimera::control {
namespace {

constexpr const char* kOf[] = {"no role", "the role observe", "the roles up to operate", "all roles but the owner's",
                               "all users"};

std::size_t places_up_to(Rank rank) { return kPlacesUpTo[static_cast<std::size_t>(rank)]; }

/// The least rank whose places, which are those of all below it too, are taken; kNone: there is one left.
Rank short_of(std::span<const Occupant> all, Rank rank) {
  for (Rank up_to = rank; up_to <= Rank::kOwner; up_to = static_cast<Rank>(static_cast<int>(up_to) + 1)) {
    const auto is_counted = [up_to](const Occupant& one) { return one.rank <= up_to; };
    if (static_cast<std::size_t>(std::count_if(all.begin(), all.end(), is_counted)) >= places_up_to(up_to))
      return up_to;
  }
  return Rank::kNone;
}

bool gives_way(const Occupant& one, Rank to) {
  if (one.rank > to || one.activity == Activity::kActs) return false;
  return one.rank < to || one.activity < Activity::kListens;
}

/// Less: gives way sooner.
auto order_of(const Occupant& one) {
  return std::tuple(one.activity > Activity::kIdle, one.rank, one.activity, one.since);
}

}  // namespace

Rank rank_of(const PeerIdentity& peer, uid_t owner) noexcept {
  const bool is_owner = peer.role == Role::kConfigure && (peer.user == 0 || peer.user == owner);
  return is_owner ? Rank::kOwner : static_cast<Rank>(peer.role);
}

PlaceGrant find_place(std::span<const Occupant> all, uid_t user, Rank rank) {
  const auto is_users = [user](const Occupant& one) { return one.user == user; };
  const bool user_is_short =
      std::count_if(all.begin(), all.end(), is_users) >= static_cast<std::ptrdiff_t>(kMaxConnectionsOfUser);
  const Rank rank_is_short = short_of(all, rank);
  if (!user_is_short && rank_is_short == Rank::kNone) return {true, 0, {}};
  const Occupant* first = nullptr;
  for (const Occupant& one : all)
    if (gives_way(one, rank) && (!user_is_short || is_users(one)) &&
        (first == nullptr || order_of(one) < order_of(*first)))
      first = &one;
  if (first != nullptr) return {true, first->number, {}};
  if (user_is_short)
    return {false, 0,
            "the " + std::to_string(kMaxConnectionsOfUser) + " of user " + std::to_string(user) + " are all in use"};
  return {false, 0,
          "the " + std::to_string(places_up_to(rank_is_short)) + " of " + kOf[static_cast<std::size_t>(rank_is_short)] +
              " are all in use"};
}

}  // namespace chimera::control
