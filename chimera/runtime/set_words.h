// SPDX-License-Identifier: Apache-2.0
// Says in words which variables make a set of ON tasks illegal. Without a heap: `put` receives the text piece by piece.
#pragma once

#include <span>
#include <string_view>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/set_equations.h"

namespace chimera {

/// "speed would have two producers: a and b; torque would have no producer"; nothing for a legal set. `on[t]`: task t
/// is in the set. `put(std::string_view)` receives the pieces in order. Context: any; O(ports), and the time of `put`.
template <class Set, class Put>
void put_set_fault(std::span<const Variable> variables, const Set& on, std::span<const TaskSpec> tasks, Put put) {
  const auto is_on = [&on](TaskId task) -> bool { return on[task.index]; };
  std::string_view joint;
  for (const Variable& variable : variables) {
    const SetFault fault = set_fault(variable, is_on);
    if (fault == SetFault::kNone) continue;
    put(joint);
    put(variable.name);
    joint = "; ";
    if (fault == SetFault::kNoProducer) {
      put(" would have no producer");
      continue;
    }
    std::string_view before = " would have two producers: ";
    for (const PortOf& producer : variable.producers) {
      if (!is_on(producer.task)) continue;
      put(before);
      put(tasks[producer.task.index].name);
      before = " and ";
    }
  }
}

}  // namespace chimera
