// SPDX-License-Identifier: Apache-2.0
// What the three rules of agreement (types, units, shapes) share: the bindings of a task's type, unit and extent
// variables.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "chimera/verify/model.h"

namespace chimera {

/// A variable of a generic component: the task, and its symbol. A symbol that only one repeated port uses stands for
/// itself in each instance, so that a logger can take signals of any kinds side by side.
using SymbolKey = std::pair<std::size_t, std::string>;

/// `uses(port, symbol)` tells whether a declared port mentions the symbol. Context: setup.
template <class Uses>
SymbolKey symbol_key(const TaskModel& task, const LinkedPort& port, const std::string& symbol, Uses uses) {
  std::size_t users = 0;
  for (const PortDescriptor& declared : task.component->ports) users += uses(declared, symbol) ? 1 : 0;
  const bool apart = users == 1 && port.declared->repeated;
  return {port.task, apart ? symbol + '#' + std::to_string(port.instance) : symbol};
}

/// What a symbol was found to be, and by which port.
template <class T>
struct Binding {
  T value;
  PortRef from;
};

template <class T>
using Bindings = std::map<SymbolKey, Binding<T>>;

/// Every port that takes part in the table or has a value: all but resources and streams.
template <class Do>
void for_each_port(Model& model, Do act) {
  for (std::size_t t = 0; t < model.tasks.size(); ++t)
    for (std::size_t p = 0; p < model.tasks[t].ports.size(); ++p)
      if (model.tasks[t].ports[p].declared->kind <= CHIMERA_OUT_CONST) act(PortRef{t, p}, model.tasks[t].ports[p]);
}

/// Producers first, then consumers: whoever comes first and is concrete settles the variable.
template <class Do>
void for_each_port_of(const VariableModel& variable, Do act) {
  for (const PortRef ref : variable.producers) act(ref);
  for (const PortRef ref : variable.consumers) act(ref);
}

/// "float64", "string[16]", "Pose". Requires: the port's type is solved. Context: setup.
std::string type_text(const LinkedPort& port);

/// "output 'q' of task 'arm' at 7:3", or the given value: who settled a variable.
std::string settled_by(const Model& model, const VariableModel& variable, const std::optional<PortRef>& from);

}  // namespace chimera
