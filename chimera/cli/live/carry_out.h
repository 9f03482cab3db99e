// SPDX-License-Identifier: Apache-2.0
// Any command on a running subsystem, wherever it was typed.
#pragma once

#include <cstdio>

#include "chimera/cli/live/commands.h"
#include "chimera/cli/live/session.h"

namespace chimera::cli {

/// Carries out `call` (not the shell's own `help` and `quit`) and prints what it says. Returns its exit code.
/// Context: setup; blocks until it is over.
int carry_out(Session& session, const Call& call, std::FILE* out, std::FILE* err);

/// carry_out() over a new connection to the subsystem that `surroundings` names.
int carry_out(const Surroundings& surroundings, const Call& call, std::FILE* out, std::FILE* err);

}  // namespace chimera::cli
