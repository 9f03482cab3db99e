// SPDX-License-Identifier: Apache-2.0
// The analysis of a configuration for people: a table, verdicts and remedies for each CPU, and its worst window.
#pragma once

#include <string>
#include <vector>

#include "chimera/analysis/schedule_report.h"
#include "chimera/draw/gantt.h"

namespace chimera::cli {

/// Everything the report says. Context: setup.
std::string schedule_text(const Configuration& configuration, const ScheduleReport& report);

/// The worst window of each CPU of the start set, to draw. Context: setup.
std::vector<draw::Gantt> schedule_pictures(const Configuration& configuration, const ScheduleReport& report);

}  // namespace chimera::cli
