// SPDX-License-Identifier: Apache-2.0
// Rules for the link between Linux and a board: which ports it can carry, and whether the line is fast enough.
// docs/formats/link.md.
#pragma once

#include "chimera/description/report.h"
#include "chimera/verify/configuration.h"

namespace chimera {

/// Adds a fault for each part of an rtpu with `link` that cannot run on a board, or cannot cross its link. Context:
/// setup.
void judge_board_links(const Configuration& configuration, Report& report);

/// By how much the links between the two tasks make a value older, while no frame is lost: for each board a period of
/// its link, the time on the line, and a period of the task on the board. 0: no link is between them. Context: setup.
Nanoseconds link_delay(const ApplicationSpec& spec, TaskId from, TaskId to);

/// Time that a frame with that payload takes on the line: ten bits a byte; 0: UDP. Context: setup.
Nanoseconds line_time(const LinkSpec& link, std::size_t payload_bytes);

}  // namespace chimera
