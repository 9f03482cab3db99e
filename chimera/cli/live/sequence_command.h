// SPDX-License-Identifier: Apache-2.0
// The command `sequence`: shows the steps of docs/formats/sequence.md, and sets `sequence_go`.
#pragma once

#include "chimera/cli/live/commands.h"

namespace chimera::cli {

/// Context: setup; may block.
CommandResult sequence(Session& session, const Call& call, const Screen& screen);
/// The steps with their names, and what the present one does, from answers to `get` and `describe`. Context: setup.
std::string sequence_text(const Json& answer, const Json& described);

}  // namespace chimera::cli
