// SPDX-License-Identifier: Apache-2.0
// One instant for which one thread waits and that others may move meanwhile.
#pragma once

#include "chimera/base/time.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

/// On CLOCK_MONOTONIC.
class Alarm {
 public:
  /// Context: setup.
  Alarm() noexcept;
  bool is_there() const noexcept { return timer_.fd >= 0; }

  /// Rings at `instant` (at once when it has passed; kNever: not at all), instead of when it was set before.
  /// Ends the process when somebody closed its descriptor, or opened something else in its place: lost_descriptor.h.
  /// Context: cycle; wait-free (one system call); any thread.
  void set(Nanoseconds instant) noexcept;
  /// Waits until it rings; ends the process as set() does. Context: cycle; blocks.
  void wait() noexcept;

 private:
  OwnedDescriptor timer_;
};

}  // namespace chimera
