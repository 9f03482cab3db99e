// SPDX-License-Identifier: Apache-2.0
// `chimera scope`: records what is published round a trigger, into a table and a picture.
#pragma once

#include "chimera/cli/live/commands.h"

namespace chimera::cli {

/// Subscribes, waits for the trigger, records, writes the files that were asked for; without --csv and --svg it says
/// the table, or, on a terminal, a line for each channel. Refuses: a variable that is none, a trigger that cannot be
/// (kUsage), one that did not come in time, nothing published, a file that cannot be written. `screen.err` gets
/// a line about what the command waits for. Context: setup; blocks at most --pre + --wait + --for and 2 s.
CommandResult scope(Session& session, const Call& call, const Screen& screen);

}  // namespace chimera::cli
