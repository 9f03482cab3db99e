// SPDX-License-Identifier: Apache-2.0
// Commands that go on until Ctrl-C, `q` or the end of the subsystem: top, watch, events --follow, get --every.
#pragma once

#include "chimera/cli/live/commands.h"

namespace chimera::cli {

/// Each prints to `out` and `err`. On a terminal top and watch draw over themselves; otherwise top prints
/// one screen and ends, watch a line each time. With --json every answer or notification is one line. Returns kOk
/// when the user ended it, kRefused when it could not go on, kUsage. Context: setup; blocks until then.
int top(Session& session, const Call& call, std::FILE* out, std::FILE* err);
int watch(Session& session, const Call& call, std::FILE* out, std::FILE* err);
int follow_events(Session& session, const Call& call, std::FILE* out, std::FILE* err);
int get_every(Session& session, const Call& call, std::FILE* out, std::FILE* err);

}  // namespace chimera::cli
