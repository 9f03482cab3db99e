// SPDX-License-Identifier: Apache-2.0
// Role and user of a request to the manager that leaves a receipt.
#pragma once

#include <cstdint>
#include <string>

#include "chimera/control/rpc_response.h"
#include "chimera/platform/process_state.h"

namespace chimera::manager {

/// Plain value.
struct Asker {
  control::Role role = control::Role::kNone;
  std::uint32_t user = 0;

  /// "operate:ann". Context: setup; reads /etc/passwd.
  std::string text() const { return std::string(control::role_name(role)) + ":" + user_name(user); }
};

}  // namespace chimera::manager
