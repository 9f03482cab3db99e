// SPDX-License-Identifier: Apache-2.0
// The switches between the configurations of a description in words: what `chimera check --modes` prints.
#pragma once

#include <string>

#include "chimera/analysis/mode_report.h"

namespace chimera::cli {

/// One line for each switch and one for each CPU that it changes; then the configurations that no task asks for.
/// Context: setup.
std::string modes_text(const Configuration& configuration, const ModeReport& report);

}  // namespace chimera::cli
