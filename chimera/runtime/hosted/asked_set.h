// SPDX-License-Identifier: Apache-2.0
// The set of tasks that "these ON, those OFF" leads to: whoever produces what the new ones produce gives way, a
// producer that is missing comes along where there is only one, and the result is judged as a configuration is.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/switch_page.h"

namespace chimera {

/// What came of it.
struct AskedSet {
  TaskBits tasks;      ///< of a set that may be switched to
  std::string why;     ///< "": it may be; else what is wrong with it
  std::string remedy;  ///< "" or what would help

  explicit operator bool() const noexcept { return why.empty(); }
};

/// From the tasks that are ON (`on[t]`: task t): all of `plus`, none of `minus`. Refuses what breaks an equation, has
/// a loop of data without an initial value, takes more of a CPU than check allows, or needs a choice (named).
/// Context: setup.
AskedSet asked_set(const ApplicationSpec& spec, std::vector<bool> on, std::span<const TaskId> plus,
                   std::span<const TaskId> minus);

}  // namespace chimera
