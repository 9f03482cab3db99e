// SPDX-License-Identifier: Apache-2.0
// The longest response of a task with a level of its own: fixed priorities.
#pragma once

#include "chimera/schedule/level.h"

namespace chimera {

/// What is known of the responses of one task.
struct Response {
  Nanoseconds most = kNever;  ///< kNever: beyond the period, or given up (the effort is spent)
  Nanoseconds blocking;       ///< part of it
};

/// Preemptive: the response of the first job after a synchronous release, C + the requests of `level.before()` until it
/// ends. Bounds every job as long as it is at most the period. Joseph & Pandya 1986. Context: setup; pure.
Response preemptive_response(const Level& level, Effort& effort) noexcept;

/// In an executive: the longest response of all jobs of the busy period that a just begun longest later job opens. A
/// job is let through until it starts; then only other bands of the CPU take it off. George, Rivierre, Spuri 1996;
/// Davis, Burns, Bril, Lukkien 2007. Context: setup; pure.
Response executive_response(const Level& level, Effort& effort) noexcept;

}  // namespace chimera
