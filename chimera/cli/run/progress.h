// SPDX-License-Identifier: Apache-2.0
// Shows on the terminal how far a long run in virtual time is.
#pragma once

#include <string>

#include "chimera/base/time.h"

namespace chimera::cli {

/// "12.0 of 60.0 s of virtual time (20 %), about 8 s to go": `wall` is what it took so far. Without an estimate while
/// nothing is done yet. Context: setup.
std::string progress_text(Nanoseconds done, Nanoseconds all, Nanoseconds wall);

}  // namespace chimera::cli
