// SPDX-License-Identifier: Apache-2.0
// `chimera schedule`: whether all tasks keep their deadlines, which do not, and which changes would help.
#pragma once

#include <string>
#include <vector>

#include "chimera/analysis/schedule_report.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/verify/setting.h"

namespace chimera::cli {

struct ScheduleRequest {
  std::string file;
  std::string profile;   ///< a recorded profile; "": budgets of the description alone
  std::string svg;       ///< draw the worst windows into this file; "": not
  std::string dispatch;  ///< "executive" or "preemptive"; "": each rtpu as described
  bool json = false;
  std::vector<Setting> settings = {};  ///< values in the place of those of the file
};

/// Reads, verifies and analyses; kOk when all fits, kRefused when not, or when the description is not legal. Context:
/// setup; may block.
CommandResult schedule(const ScheduleRequest& request, const Workplace& workplace);

}  // namespace chimera::cli
