// SPDX-License-Identifier: Apache-2.0
// Remedies that are edits. Each is tried before it is offered.
#pragma once

#include <cstddef>

#include "chimera/verify/outline.h"

namespace chimera {

/// Edits tried for one report. Each takes the time of a verification.
inline constexpr std::size_t kMostEditTries = 32;

/// Fills Fault::offers. After an offered edit the fault is gone, there are fewer errors (or warnings, for a warning),
/// and no error that was not there before. The likeliest edit of each fault is tried first. Context: setup.
void offer_edits(const ReadDescription& reading, const Library& library, Outlined& outlined,
                 std::size_t most_tries = kMostEditTries);

}  // namespace chimera
