// SPDX-License-Identifier: Apache-2.0
// A switch that names tasks and no configuration: which set it leads to depends on what is ON by then.
#pragma once

#include "chimera/base/time.h"
#include "chimera/runtime/switch_page.h"
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

}  // namespace chimera
