// SPDX-License-Identifier: Apache-2.0
// `chimera receipts`: results of the last switches, from the manager or, when none runs, from the file.
#pragma once

#include <cstdint>
#include <string>

#include "chimera/cli/live/commands.h"
#include "chimera/text/json.h"

namespace chimera::cli {

// Context of all: setup; may block.
CommandResult receipts(Session& session, const Call& call, const Screen& screen);
/// The receipts in the file of a subsystem that does not run. Answers `why`, the reason why it does not, if there are
/// none in the file. `subsystem`: "" stands for the only one that has receipts.
CommandResult filed_receipts(const Call& call, const std::string& subsystem, const Error& why);

/// An answer of `receipts` as a table, with a line for each one that was not done.
std::string receipts_text(const Json& answer);

}  // namespace chimera::cli
