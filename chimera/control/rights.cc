// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/rights.h"

#include <sys/socket.h>

#include <algorithm>
#include <vector>

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
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return {};
  std::vector<gid_t> groups(64);
  socklen_t bytes = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
  if (::getsockopt(descriptor, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) {
    groups.resize(bytes / sizeof(gid_t));  // says how many there are
    if (::getsockopt(descriptor, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) bytes = 0;
  }
  groups.resize(bytes / sizeof(gid_t));
  groups.push_back(peer.gid);
  return {peer.uid, role_of(peer.uid, groups, owner, rules), peer.pid};
}

}  // namespace chimera::control
