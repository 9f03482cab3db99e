// SPDX-License-Identifier: Apache-2.0
// What the kernel says of another process: whether it runs, and who keeps it from running.
#pragma once

#include <sys/types.h>

#include "chimera/base/time.h"

namespace chimera {

/// Of the process's main thread. A stop by a signal or a debugger stops all threads.
struct ProcessState {
  char letter =
      0;  ///< as `ps` shows it: R runs or would like to, S waits, D waits for a disk, T t stopped; 0: not known
  Nanoseconds used;  ///< time that the main thread had of a processor, in steps of 10 ms
  pid_t tracer = 0;  ///< the debugger that holds it; 0: none
};

/// Read from /proc; all 0 when there is no such process. Context: setup; never blocks.
ProcessState process_state(pid_t pid) noexcept;

}  // namespace chimera
