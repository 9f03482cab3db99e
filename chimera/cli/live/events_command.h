// SPDX-License-Identifier: Apache-2.0
// `chimera events`: the events of a subsystem, from the manager or, when none runs, from the file.
#pragma once

#include <string>

#include "chimera/cli/live/commands.h"
#include "chimera/cli/print/event_lines.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// The options of the command. Plain value.
struct EventChoice {
  Since since;
  EventLines lines;
};
/// Refuses an option that cannot be read. `is_dated`: lines have a date even if --since names no time. Context: setup.
Result<EventChoice> read_choice(const Call& call, bool is_dated = false);
/// An answer of `events` without unwanted events. Context: setup.
Json only(const EventLines& lines, Json answer);

// Context of both: setup; may block.
CommandResult events(Session& session, const Call& call, const Screen& screen);
/// The events in the file of a subsystem that does not run: those of its last run, or all since a time. Answers `why`,
/// the reason why it does not run, if the file has none.
CommandResult filed_events(const Call& call, const std::string& subsystem, const Error& why);

}  // namespace chimera::cli
