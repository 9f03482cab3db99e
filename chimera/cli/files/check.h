// SPDX-License-Identifier: Apache-2.0
// `chimera check`: is this description legal? And its picture.
#pragma once

#include <string>
#include <vector>

#include "chimera/cli/files/file_refusal.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/setting.h"
#include "chimera/verify/verify.h"

namespace chimera::cli {

struct CheckOptions {
  std::string file;
  bool json = false;
  std::string graph;  ///< "", "dot", "svg" or "text"
  bool modes = false;   ///< judge the switches between its configurations instead
  std::vector<Setting> settings = {};  ///< values in the place of those of the file
};

/// Reads and verifies; code kRefused when the description has a fault, or a reaction asks for a switch that would be
/// refused. Context: setup; may block.
CommandResult check(const CheckOptions& options, const Workplace& workplace);

/// The lines that a legal description earns: tasks, order, load; `with_cycles`: also orders that a policy makes.
std::string verdict_text(const Configuration& configuration, bool with_cycles = false);

}  // namespace chimera::cli
