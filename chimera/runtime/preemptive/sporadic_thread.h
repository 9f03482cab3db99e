// SPDX-License-Identifier: Apache-2.0
// Additions to the thread of a task behind a server: the server pays for the execution time of the thread, and a job
// that runs out of capacity is halted in the middle until some is back.
#pragma once

#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"
#include "chimera/runtime/job/sporadic_job.h"

namespace chimera {

/// Touched in the section, unless said otherwise. Context: cycle; wait-free, unless said otherwise.
class SporadicThread {
 public:
  /// Context: setup.
  explicit SporadicThread(const ServerSpec& spec) noexcept;

  SporadicJob& job() noexcept { return job_; }
  const SporadicJob& job() const noexcept { return job_; }
  /// Where the thread waits while it listens to a descriptor, in place of JobThread's own bell. Context: any.
  DescriptorBell& bell() noexcept { return bell_; }

  /// The server is full at `origin` and pays for the time that `thread` uses from here on.
  void start(pid_t thread, Nanoseconds origin) noexcept;
  /// Charges the server for what `thread` has used since the last time, its way to its label included: a storm of
  /// events costs the others no more than the capacity. `is_free`: it ran below all others, where no server counts.
  void charge(pid_t thread, bool is_free) noexcept;

  /// The job is in the middle and stands still for want of capacity.
  bool is_halted() const noexcept { return is_halted_; }
  void halt() noexcept;
  /// The job goes on; no effect on one that is not halted.
  void resume() noexcept;
  /// The job is over. It may have come to its end when it was about to be halted.
  void finish(pid_t thread, bool is_free) noexcept;

  /// Halts act on the calling thread. Context: setup; the thread itself.
  void attach() noexcept { halt_.attach(); }
  /// The body begins, and may be halted from here on. Context: the thread itself; outside the section; may block.
  void open() noexcept { halt_.open(); }
  /// The body has ended. Context: the thread itself; outside the section.
  void close() noexcept { halt_.close(); }

 private:
  SporadicJob job_;
  Nanoseconds charged_;  // execution time of the thread up to which the server has paid
  bool is_halted_ = false;
  Halt halt_;
  DescriptorBell bell_;
};

}  // namespace chimera
