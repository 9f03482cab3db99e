// SPDX-License-Identifier: Apache-2.0
// Names, units, steps and words of receipts.
#include "chimera/control/receipt/receipt_parts.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/plan/switch_words.h"

namespace chimera::control {

std::string number_text(double value) { return formatted("%.6g", value); }

const char* word(SwitchEnd end) { return end_word(end); }

const char* word(TaskMove move) {
  switch (move) {
    case TaskMove::kArrives: return "arrives";
    case TaskMove::kLeaves: return "leaves";
    case TaskMove::kStays: return "stays";
  }
  return "?";
}

const PortSpec* port_of(const Variable& variable, const ApplicationSpec& spec) {
  if (!variable.producers.empty()) return spec.port(CHIMERA_OUT_VAR, variable.producers[0]);
  return variable.consumers.empty() ? nullptr : spec.port(CHIMERA_IN_VAR, variable.consumers[0]);
}

std::string unit_of(const VariablePart& part, const ApplicationSpec& spec) {
  const PortSpec* const port = spec.port(CHIMERA_OUT_VAR, part.handover.to);
  return port == nullptr ? "1" : std::string(port->unit);
}

std::string unit_text(const std::string& unit) { return unit == "1" ? "" : " " + unit; }
std::string unit_text(const VariablePart& part, const ApplicationSpec& spec) { return unit_text(unit_of(part, spec)); }

std::string step_text(const ValueStep& step, const std::string& unit) {
  return number_text(step.size) + unit + (step.limit > 0 ? ", limit " + number_text(step.limit) + unit : "");
}

const ValueStep& seen(const VariablePart& part) {
  return part.step_of_cycle.is_known ? part.step_of_cycle : part.step_of_on;
}

}  // namespace chimera::control
