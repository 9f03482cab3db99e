// SPDX-License-Identifier: Apache-2.0
// The commands of more than one request, or with an option that is judged here, before a request is sent.
#pragma once

#include "chimera/cli/live/commands.h"

namespace chimera::cli {

// Context of all: setup; may block.
CommandResult turn_on(Session& session, const Call& call, const Screen& screen);
CommandResult status(Session& session, const Call& call, const Screen& screen);
CommandResult profile(Session& session, const Call& call, const Screen& screen);
CommandResult save(Session& session, const Call& call, const Screen& screen);
CommandResult flag(Session& session, const Call& call, const Screen& screen);
CommandResult switch_to(Session& session, const Call& call, const Screen& screen);
CommandResult drill(Session& session, const Call& call, const Screen& screen);
CommandResult why(Session& session, const Call& call, const Screen& screen);
CommandResult end(Session& session, const Call& call, const Screen& screen);

}  // namespace chimera::cli
