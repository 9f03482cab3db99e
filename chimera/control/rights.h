// SPDX-License-Identifier: Apache-2.0
// Who is at the other end of a connection and what it may do: docs/formats/control.md, "Rights".
#pragma once

#include <optional>
#include <span>

#include "chimera/control/rpc_response.h"
#include "chimera/platform/process_id.h"

namespace chimera::control {

/// Groups whose members get a role; none by default.
struct RoleGroups {
  std::optional<gid_t> observe, operate, configure;
};

struct PeerIdentity {
  uid_t user = static_cast<uid_t>(-1);
  Role role = Role::kNone;
  pid_t process = 0;  ///< that connected; 0: not known
};

/// The highest role of a peer with that user and those groups; `owner` is the user of the keeper. Context: any.
Role role_of(uid_t user, std::span<const gid_t> groups, uid_t owner, const RoleGroups& rules) noexcept;
/// Asks the kernel who connected (SO_PEERCRED, SO_PEERGROUPS). Context: setup.
PeerIdentity identify(int descriptor, uid_t owner, const RoleGroups& rules);

}  // namespace chimera::control
