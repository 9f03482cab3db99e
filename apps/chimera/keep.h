// SPDX-License-Identifier: Apache-2.0
// `chimera run` in real time: verified here, then run by processes of which this one is the keeper.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "chimera/catalogue/workplace.h"
#include "chimera/cli/run/run.h"

/// The request of a run, and the other settings of the keeper.
struct KeepRequest {
  chimera::cli::RunRequest run;
  bool flash = false;             ///< build and load the images of boards
  std::vector<std::string> face;  ///< the arguments of `chimera attend` that stand on the command line of `run`
  std::optional<std::uint32_t> observe_group, operate_group, configure_group;
};

/// Answers the exit code of the run. Context: setup, the first thread; blocks for the duration.
int keep(const KeepRequest& request, const chimera::Workplace& workplace);

/// A subsystem of that name with nothing loaded: serves `check`, `schedule` and `library` to editors until it is ended.
int keep_idle(const std::string& subsystem, const chimera::Workplace& workplace);
