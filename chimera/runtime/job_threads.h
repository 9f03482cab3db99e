// SPDX-License-Identifier: Apache-2.0
// Who runs the jobs, where that is not the executor's own thread.
#pragma once

#include "chimera/base/ids.h"
#include "chimera/base/time.h"

namespace chimera {

/// Every task has a thread.
class JobThreads {
 public:
  /// Keeps the task's thread from beginning a job until the edge is over; a job that waits is put back. False while a
  /// job of it is under way: then an edge follows its end. Context: edge; wait-free.
  virtual bool claim(TaskId task) noexcept = 0;
  /// Execution time of the job of the task that is under way; 0 without one. Context: edge; wait-free.
  virtual Nanoseconds used_by_job(TaskId task) noexcept = 0;
  /// True while a job of the task that is under way waits for something in a system call. A look into the kernel's
  /// files, meanwhile others may act: what the caller knows of jobs may be over. Context: edge; some microseconds.
  virtual bool is_blocked(TaskId task) noexcept = 0;

 protected:
  ~JobThreads() = default;
};

}  // namespace chimera
