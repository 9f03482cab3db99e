// SPDX-License-Identifier: Apache-2.0
// Binds the type, unit and extent variables of a task, and names what bound them.
#include "chimera/verify/solve.h"

namespace chimera {

std::string type_text(const LinkedPort& port) {
  if (port.declared->type == CHIMERA_STRUCT) return port.declared->type_name;
  const std::string name(type_name(*port.type));
  return *port.type == CHIMERA_STRING ? name + '[' + std::to_string(port.element_bytes) + ']' : name;
}

std::string settled_by(const Model& model, const VariableModel& variable, const std::optional<PortRef>& from) {
  if (from) {
    const LinkedPort& port = model.port(*from);
    return model.say(port) + " at " + Model::say(port.at);
  }
  return "the value at " + Model::say(variable.given->value.at);
}

}  // namespace chimera
