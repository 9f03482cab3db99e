// SPDX-License-Identifier: Apache-2.0
// Derives the role of a connection from the user and groups of its process.
#include "chimera/control/rights.h"

#include <algorithm>

#include "chimera/platform/local_socket.h"

namespace chimera::control {

Role role_of(uid_t user, std::span<const gid_t> groups, uid_t owner, const RoleGroups& rules) noexcept {
  if (user == 0 || user == owner) return Role::kConfigure;
  const auto is_in = [groups](const std::optional<gid_t>& wanted) {
    return wanted && std::find(groups.begin(), groups.end(), *wanted) != groups.end();
  };
  if (is_in(rules.configure)) return Role::kConfigure;
  if (is_in(rules.operate)) return Role::kOperate;
  return is_in(rules.observe) ? Role::kObserve : Role::kNone;
}

PeerIdentity identify(int descriptor, uid_t owner, const RoleGroups& rules) {
  const auto peer = peer_of(descriptor);
  if (!peer) return {};
  return {peer->user, role_of(peer->user, peer->groups, owner, rules), peer->process};
}

}  // namespace chimera::control
