// SPDX-License-Identifier: Apache-2.0
// The boards of a run: judged before it starts; with --flash, their images are built and loaded.
#pragma once

#include <vector>

#include "chimera/catalogue/workplace.h"
#include "chimera/cli/run/run_plan.h"
#include "chimera/platform/process.h"

/// The programs that hold the boards, which end with this process. Refuses with all reasons if a board cannot run its
/// part, with `flash` also if the image cannot be built or loaded. `file`: the description. Context: setup; with
/// `flash` it blocks for the time of a build.
chimera::Result<std::vector<chimera::Process>> take_boards(const chimera::cli::RunPlan& plan, const std::string& file,
                                                           const chimera::Workplace& workplace, bool flash);
