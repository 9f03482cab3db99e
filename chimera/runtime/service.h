// SPDX-License-Identifier: Apache-2.0
// The thread that runs init and kill: these may take long and may block, so they never run on the thread that cycles.
#pragma once

#include "chimera/base/ids.h"

namespace chimera {

/// A thread of ordinary priority beside the context. It calls SlowMethods::run(task); then the context's thread
/// calls TaskLife::finish_slow(task) at a cycle boundary.
class Service {
 public:
  /// Takes over the task until it is served. Context: cycle boundary; wait-free.
  virtual void ask(TaskId task) noexcept = 0;
  /// A task that was served; false when there is none. Context: cycle boundary; wait-free.
  virtual bool take_served(TaskId& task) noexcept = 0;

 protected:
  ~Service() = default;
};

}  // namespace chimera
