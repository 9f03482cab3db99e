// SPDX-License-Identifier: Apache-2.0
// The tasks that use the CPUs while a set is ON. The limit of the load and the analysis judge each of these lists.
#pragma once

#include <span>
#include <vector>

#include "chimera/runtime/application_spec.h"

namespace chimera {

/// Tasks that cycle at the same time.
struct Together {
  std::vector<TaskId> tasks;  ///< the ON tasks, then the hot standbys that cycle beside them
  TaskId primary, standby;    ///< `standby` is ON in place of `primary`; invalid in the list of the set itself

  bool is_takeover() const noexcept { return standby.is_valid(); }
};

/// The set itself, then the set with each standby in place of its primary, in the order of `standbys`. Context: setup.
std::vector<Together> all_together(std::span<const StandbySpec> standbys, std::span<const TaskId> set);

}  // namespace chimera
