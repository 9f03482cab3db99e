// SPDX-License-Identifier: Apache-2.0
// A switch that names tasks and no configuration: which set it leads to depends on what is ON by then.
#pragma once

#include <span>

#include "chimera/base/time.h"
#include "chimera/runtime/switch_plan.h"
#include "chimera/runtime/switch_request.h"

namespace chimera {

/// Asked by whoever carries out a script and the requests of tasks.
class AskedTasks {
 public:
  virtual ~AskedTasks() = default;
  /// Writes the tasks that are to be ON after `on` is and the lists of the request are carried out; false: they would
  /// be no legal set, and nothing is switched. `now` is on the executor's clock. Context: edge; may allocate.
  virtual bool find(const SwitchRequest& request, const TaskBits& on, Nanoseconds now, TaskBits& target) = 0;
};

/// Which tasks are ON. Context: edge; wait-free.
TaskBits tasks_on(std::span<const TaskStanding> standing) noexcept;

/// The tasks that are to be ON after a request, whose set is then one of those of the spec, or kNoSet; false: they
/// would be no legal set. Requires: `asked` where the request has lists. Context: edge; as AskedTasks::find().
bool find_target(SwitchRequest& request, const ApplicationSpec& spec, std::span<const TaskStanding> standing,
                 AskedTasks* asked, Nanoseconds now, TaskBits& target) noexcept;

}  // namespace chimera
