// SPDX-License-Identifier: Apache-2.0
// The tasks that use the CPUs while a set is ON. The limit of the load and the analysis judge each of these lists.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chimera/runtime/application_spec.h"
#include "chimera/schedule/utilisation.h"

namespace chimera {

/// Tasks that cycle at the same time.
struct Together {
  std::vector<TaskId> tasks;  ///< the ON tasks, then the hot standbys that cycle beside them
  TaskId primary, standby;    ///< `standby` is ON in place of `primary`; invalid in the list of the set itself

  bool is_takeover() const noexcept { return standby.is_valid(); }
};

/// The set itself, then the set with each standby in place of its primary, in the order of `standbys`. Context: setup.
std::vector<Together> all_together(std::span<const StandbySpec> standbys, std::span<const TaskId> set);

/// Budgets beyond a limit.
struct Excess {
  std::uint32_t cpu = 0;
  double load = 0;
  Together together;
};

/// The first CPU, and the first of all_together(), whose budgets exceed the limit; none: the set is within it.
/// `on_one_cpu`: all rtpus share the CPU of the first. Context: setup.
std::optional<Excess> excess_of(const ApplicationSpec& spec, std::span<const TaskId> set,
                                double limit = kMaxUtilisation, bool on_one_cpu = false);
/// " with 'spare' for 'pid'"; empty: the set itself. Context: setup.
std::string takeover_text(const ApplicationSpec& spec, const Together& together);
/// "the budgets with 'spare' for 'pid' would take 1.400 of CPU 0; expected at most 0.93". Context: setup.
std::string excess_text(const ApplicationSpec& spec, const Excess& excess);

}  // namespace chimera
