// SPDX-License-Identifier: Apache-2.0
// The two set equations of the 1994 paper, section 3.2, over one state variable and the tasks of a set. Verification
// checks them for each configuration, the runtime for the tasks that are (or would be) ON.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace chimera {

/// Fault of a variable in a set of tasks.
enum class SetFault : std::uint8_t {
  kNone,
  kTwoProducers,  ///< equation 1: two tasks of the set produce it, or one does beside the operator
  kNoProducer     ///< equation 2: a task of the set needs it and no task produces it
};

/// Judges a Variable, or a VariableModel of verification. `produces(task)` says whether the task is in the set, and
/// `needs(port)` whether an input in it must have a producer. Context: any; O(ports).
template <class Variable, class Produces, class Needs>
SetFault set_fault(const Variable& variable, Produces produces, Needs needs) {
  std::size_t n = variable.is_given() ? 1 : 0;
  for (const auto& port : variable.producers)
    if (produces(port.task) && ++n > 1) return SetFault::kTwoProducers;
  if (n == 1) return SetFault::kNone;
  for (const auto& port : variable.consumers)
    if (needs(port)) return SetFault::kNoProducer;
  return SetFault::kNone;
}

/// Judges one variable where `is_on(task)` says whether the task is in the set. Context: any; O(ports).
template <class Variable, class IsOn>
SetFault set_fault(const Variable& variable, IsOn is_on) {
  return set_fault(variable, is_on, [&](const auto& port) { return !port.intermittent && is_on(port.task); });
}

/// True if the set obeys both equations for each of the `variables` (runtime/application_spec.h). `on[t]`: task t is
/// in the set. Context: any; O(ports).
template <class Variables, class Set>
bool is_legal_set(const Variables& variables, const Set& on) {
  const auto is_on = [&on](auto task) -> bool { return on[task.index]; };
  return std::all_of(variables.begin(), variables.end(),
                     [&](const auto& variable) { return set_fault(variable, is_on) == SetFault::kNone; });
}

}  // namespace chimera
