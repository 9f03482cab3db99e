// SPDX-License-Identifier: Apache-2.0
// The advice of the schedule analysis, in words.
#pragma once

#include <string>

#include "chimera/analysis/schedule_report.h"

namespace chimera {

/// "task 'a' at rate: 90.9 Hz". Context: setup.
std::string remedy_text(const Configuration& configuration, const Remedy& remedy);

/// "1.25 times as long as stated". Context: any.
std::string scale_text(double scale);

}  // namespace chimera
