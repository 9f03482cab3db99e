// SPDX-License-Identifier: Apache-2.0
// Services of the framework for a component while one of its methods runs: chimera_host of chimera/task/abi.h.
#pragma once

#include <cstdint>

#include "chimera/runtime/job/job_clock.h"
#include "chimera/task/task.h"

namespace chimera {

class TaskSet;
class StaleInputs;

/// Data of one task; chimera_call::context points at it.
struct TaskHost {
  TaskSet* set = nullptr;
  Task* task = nullptr;
  JobClock* clock = nullptr;  ///< of the thread that runs the method; null: that of the context
  StaleInputs* stale = nullptr;  ///< judges the age of its inputs; null: their age is not judged

  /// The functions behind chimera_call::host.
  static const chimera_host kCalls;
};

}  // namespace chimera
