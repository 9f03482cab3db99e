// SPDX-License-Identifier: Apache-2.0
// The two set equations of the 1994 paper, section 3.2, over one state variable and the tasks of a set. Verification
// checks them for each configuration, the runtime for the tasks that are (or would be) ON.
#pragma once

#include <cstddef>
#include <cstdint>

namespace chimera {

/// Fault of a variable in a set of tasks.
enum class SetFault : std::uint8_t {
  kNone,
  kTwoProducers,  ///< equation 1: two tasks of the set produce it, or one does beside the operator
  kNoProducer     ///< equation 2: a task of the set reads it and no task produces it
};

/// Judges one variable. `producers` and `consumers` are its ports, `is_given` says whether the operator produces it;
/// `produces(port)` and `reads(port)` say whether the task of a port is in the set. Context: any; O(ports).
template <class Ports, class Produces, class Reads>
SetFault set_fault(const Ports& producers, const Ports& consumers, bool is_given, Produces produces, Reads reads) {
  std::size_t n = is_given ? 1 : 0;
  for (const auto& port : producers)
    if (produces(port) && ++n > 1) return SetFault::kTwoProducers;
  if (n == 1) return SetFault::kNone;
  for (const auto& port : consumers)
    if (reads(port)) return SetFault::kNoProducer;
  return SetFault::kNone;
}

/// True if the set obeys both equations for each of the `variables` (runtime/application_spec.h). `on[t]`: task t is
/// in the set. Context: any; O(ports).
template <class Variables, class Set>
bool is_legal_set(const Variables& variables, const Set& on) {
  const auto is_on = [&on](const auto& port) -> bool { return on[port.task.index]; };
  for (const auto& variable : variables) {
    const bool is_given = variable.operator_index != UINT32_MAX;
    if (set_fault(variable.producers, variable.consumers, is_given, is_on, is_on) != SetFault::kNone) return false;
  }
  return true;
}

}  // namespace chimera
