// SPDX-License-Identifier: Apache-2.0
// A time as people read it.
#pragma once

#include <string>

#include "chimera/base/time.h"

namespace chimera {

/// "1.5 ms", in the largest unit that gives at least 1; at most four digits. Context: any.
std::string time_text(Nanoseconds time);

}  // namespace chimera
