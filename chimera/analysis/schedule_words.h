// SPDX-License-Identifier: Apache-2.0
// The advice of the schedule analysis, in words and as edits.
#pragma once

#include <string>
#include <vector>

#include "chimera/analysis/schedule_report.h"
#include "chimera/description/edit_act.h"

namespace chimera {

/// "task 'a' at rate: 90.9 Hz". Context: setup.
std::string remedy_text(const Configuration& configuration, const Remedy& remedy);

/// The acts that make this change in the text of the description. Context: setup.
std::vector<EditAct> remedy_acts(const Configuration& configuration, const Remedy& remedy);

/// "1.25 times as long as stated". Context: any.
std::string scale_text(double scale);

}  // namespace chimera
