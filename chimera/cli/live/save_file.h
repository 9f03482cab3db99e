// SPDX-License-Identifier: Apache-2.0
// `chimera save --write`: the operator's present values into the description file; nothing else in it changes.
#pragma once

#include "chimera/cli/live/commands.h"
#include "chimera/cli/live/session.h"

namespace chimera::cli {

/// Asks for the values, edits the file that the subsystem was started from, has the result checked by the subsystem,
/// and puts it in the place of the old file in one step. Refuses, changing nothing: a file that changed since the
/// start (but by this command), one that cannot be read or written, a result that is not legal. Context: setup; may
/// block.
CommandResult save_to_file(Session& session, const Call& call);

}  // namespace chimera::cli
