// SPDX-License-Identifier: Apache-2.0
// Times and remedies of the analysis in words.
#pragma once

#include <string>

#include "chimera/config/schedule_report.h"

namespace chimera {

/// "1.5 ms", in the largest unit that gives at least 1; at most four digits. Context: any.
std::string time_text(Nanoseconds time);

/// "task 'a' at rate: 90.9 Hz". Context: setup.
std::string remedy_text(const Configuration& configuration, const Remedy& remedy);

/// "1.25 times as long as stated". Context: any.
std::string scale_text(double scale);

}  // namespace chimera
