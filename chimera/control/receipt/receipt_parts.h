// SPDX-License-Identifier: Apache-2.0
// Parts of the texts of receipts: names, units, steps, words.
#pragma once

#include <string>
#include <string_view>

#include "chimera/runtime/plan/switch_receipt.h"

namespace chimera::control {

/// Six digits. Context of everything: setup.
std::string number_text(double value);
const char* word(SwitchEnd end);
const char* word(TaskMove move);
/// Port of a producer of the variable; if there is none, of a reader; null: there is neither.
const PortSpec* port_of(const Variable& variable, const ApplicationSpec& spec);
/// Unit of the variable, "1" without one.
std::string unit_of(const VariablePart& part, const ApplicationSpec& spec);
/// The unit as it stands behind a number.
std::string unit_text(const std::string& unit);
std::string unit_text(const VariablePart& part, const ApplicationSpec& spec);
/// "0.25 N.m, limit 5 N.m".
std::string step_text(const ValueStep& step, const std::string& unit);
/// The step that readers saw first: of the first cycle of the producer after the switch, else of its `on`.
const ValueStep& seen(const VariablePart& part);

}  // namespace chimera::control
