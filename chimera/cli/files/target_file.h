// SPDX-License-Identifier: Apache-2.0
// Finds the target of a board: a name of firmware/targets, or a file.
#pragma once

#include <string>

#include "chimera/bake/target.h"
#include "chimera/base/result.h"
#include "chimera/catalogue/workplace.h"

namespace chimera::cli {

/// Reads the target of that name, or the file if the name ends in .yaml; `file` gets its path. Refuses what cannot be
/// read; faults of the text are in the report. Context: setup; may block.
Result<bake::ReadTarget> read_target_named(const std::string& name, const Workplace& workplace, std::string& file);

}  // namespace chimera::cli
