// SPDX-License-Identifier: Apache-2.0
// What the texts of receipts are put together from: names, units, steps, words.
#pragma once

#include <string>
#include <string_view>

#include "chimera/runtime/switch/switch_receipt.h"

namespace chimera::control {

/// "'pid'". Context of everything: setup.
std::string quoted(std::string_view name);
/// Six digits.
std::string number_text(double value);
const char* word(SwitchEnd end);
const char* word(TaskMove move);
/// Of a task that produces the variable, else of one that reads it; null: there is none.
const PortSpec* port_of(const Variable& variable, const ApplicationSpec& spec);
/// Of the variable, "1" without one.
std::string unit_of(const VariablePart& part, const ApplicationSpec& spec);
/// As it stands behind a number.
std::string unit_text(const std::string& unit);
std::string unit_text(const VariablePart& part, const ApplicationSpec& spec);
/// "0.25 N.m, limit 5 N.m".
std::string step_text(const ValueStep& step, const std::string& unit);
/// What readers saw first: the first cycle of the producer after, else what its `on` wrote.
const ValueStep& seen(const VariablePart& part);

}  // namespace chimera::control
