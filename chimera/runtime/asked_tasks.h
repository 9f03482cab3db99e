// SPDX-License-Identifier: Apache-2.0
// A switch that names tasks and no configuration: which set it leads to depends on what is ON by then.
#pragma once

#include "chimera/base/time.h"
#include "chimera/runtime/switch_page.h"

namespace chimera {

/// Asked by whoever carries out a script.
class AskedTasks {
 public:
  virtual ~AskedTasks() = default;
  /// Writes the tasks that are to be ON after `on` is; false: they would be no legal set, and nothing is switched.
  /// `now` is on the executor's clock. Context: edge; may allocate.
  virtual bool find(const TaskBits& on, Nanoseconds now, TaskBits& target) = 0;
};

}  // namespace chimera
