// SPDX-License-Identifier: Apache-2.0
// The longest response of a task that is alone in its level: fixed priorities.
#pragma once

#include "chimera/schedule/level.h"

namespace chimera {

/// Bounds for the responses of one task.
struct Response {
  Nanoseconds most = kNever;  ///< kNever: beyond the period, or the effort is spent
  Nanoseconds blocking;       ///< part of `most`
};

/// Preemptive: the response of the first job after a synchronous release. It is C plus the requests of `level.before()`
/// until its end, and bounds every job if it is at most the period. Joseph & Pandya 1986. Context: setup; pure.
Response preemptive_response(const Level& level, Effort& effort) noexcept;

/// In an executive: the longest response of all jobs in the busy period that opens just after the longest later job
/// began. Earlier jobs delay a job until it starts; then only other bands of the CPU preempt it. George, Rivierre,
/// Spuri 1996; Davis, Burns, Bril, Lukkien 2007. Context: setup; pure.
Response executive_response(const Level& level, Effort& effort) noexcept;

}  // namespace chimera
