// SPDX-License-Identifier: Apache-2.0
// Describes in words why a signal, or the start of an application, was refused.
#pragma once

#include <string>

#include "chimera/base/result.h"
#include "chimera/runtime/life/task_set.h"

namespace chimera {

/// A refused report with the smallest legal set where that helps; "" when it was accepted. For a report of the last
/// call of TaskLife::signal(). Context: setup; may block.
std::string refusal_text(TaskSet& set, const SignalReport& report);

/// Why a signal was refused with Refusal::kSwitch; `set` as SignalReport::set. Context: setup; may block.
std::string under_way_text(const ApplicationSpec& spec, std::uint32_t set);

/// The report of TaskLife::start() of the set, as a result. Context: setup; may block.
Result<void> start_result(TaskSet& set, const SignalReport& report);

}  // namespace chimera
