// SPDX-License-Identifier: Apache-2.0
// Names, units, steps and words of receipts.
#include "chimera/control/receipt/receipt_parts.h"

#include "chimera/base/hosted/wording.h"

namespace chimera::control {
namespace {

/// The port of that kind; null: there is none.
const PortSpec* find_port(const PortOf& of, int kind, const ApplicationSpec& spec) {
  std::uint32_t n = 0;
  for (const PortSpec& port : spec.tasks[of.task.index].ports)
    if (port.kind == static_cast<std::uint32_t>(kind) && n++ == of.index) return &port;
  return nullptr;
}

}  // namespace

std::string number_text(double value) { return formatted("%.6g", value); }

const char* word(SwitchEnd end) {
  switch (end) {
    case SwitchEnd::kDone: return "done";
    case SwitchEnd::kAborted: return "aborted";
    case SwitchEnd::kRefused: return "refused";
    case SwitchEnd::kNothingToDo: return "nothing-to-do";
  }
  return "?";
}

const char* word(TaskMove move) {
  switch (move) {
    case TaskMove::kArrives: return "arrives";
    case TaskMove::kLeaves: return "leaves";
    case TaskMove::kStays: return "stays";
  }
  return "?";
}

const PortSpec* port_of(const Variable& variable, const ApplicationSpec& spec) {
  if (!variable.producers.empty()) return find_port(variable.producers[0], CHIMERA_OUT_VAR, spec);
  return variable.consumers.empty() ? nullptr : find_port(variable.consumers[0], CHIMERA_IN_VAR, spec);
}

std::string unit_of(const VariablePart& part, const ApplicationSpec& spec) {
  const PortSpec* const port = find_port(part.handover.to, CHIMERA_OUT_VAR, spec);
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
