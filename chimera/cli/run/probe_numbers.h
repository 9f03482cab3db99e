// SPDX-License-Identifier: Apache-2.0
// The names of the numbers of a variable, one by one, in the order of Seen::numbers.
#pragma once

#include <string>
#include <vector>

#include "chimera/cli/run/application.h"

namespace chimera::cli {

/// "error"; of a list "q[0]"; of a struct "target.position[2]". Context: setup.
std::vector<std::string> number_names(const Probe& probe);
/// The unit of each number. Context: setup.
std::vector<std::string> number_units(const Probe& probe);

}  // namespace chimera::cli
