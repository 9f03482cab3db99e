// SPDX-License-Identifier: Apache-2.0
// The session (all processes that one terminal started) and the folder in which a subsystem was started.
#pragma once

#include <cstdint>
#include <string>

#include "chimera/control/rpc_response.h"

namespace chimera::control {

/// Parts of the answer of `hello` that say where a subsystem belongs (docs/formats/control.md). Plain value.
struct Home {
  std::string subsystem;
  std::int64_t keeper_pid = 0;
  /// Number of the session of its keeper; 0: one whose leader is outside this container, -1: not known.
  std::int64_t session = -1;
  std::string folder;        ///< in which `chimera run` was typed
  std::string file;          ///< the description, as it was named there
};

/// Reads the answer of `hello`; members that it lacks stay empty. Context of all: setup; may block.
Home home_of(const Json& hello);
/// True if the subsystem belongs to the caller's terminal, that is, to the same session. All sessions from outside of a
/// container count as one, because the container cannot distinguish them. Also true if it was started in the caller's
/// working folder, or from a description in that folder.
bool is_here(const Home& home);

}  // namespace chimera::control
