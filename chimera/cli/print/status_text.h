// SPDX-License-Identifier: Apache-2.0
// The answers `status` and `profile` (docs/formats/control.md) as tables for people.
#pragma once

#include <string>

#include "chimera/text/json.h"

namespace chimera::cli {

/// "puma_pid: run, up 12.5 min, flag down": what is true of the whole subsystem. Context of all: setup.
std::string headline(const Json& status);
/// "flag down", or "flag UP by servo, operator".
std::string flag_words(const Json& flag);
/// Share of the capacity of its server (an object as in docs/formats/run.md) that a task with this load uses.
double share_of_server(const Json& server, double load);
/// "servo serving, restarted 2 times, running pid.cycle, FLAG; last end: ...".
std::string rtpu_remarks(const Json& rtpu);
/// The age of the oldest input of a task and the variable; none of them ever written: no variable, age -1.
struct OldestInput {
  std::int64_t age_ns = -1;
  std::string variable;
};
OldestInput oldest_input(const Json& task);

/// The headline, a table of the rtpus, a table of the tasks, and a line for every task with a fault.
std::string status_text(const Json& status);

/// One line a task: cycles, execution time of cycle, load, response, start jitter, failures; then the last faults, the
/// other methods, transfers, and the sums of each rtpu.
std::string profile_text(const Json& answer);

}  // namespace chimera::cli
