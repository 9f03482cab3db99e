// SPDX-License-Identifier: Apache-2.0
// Where one thread waits for a descriptor to become readable, and anybody may wake it meanwhile.
#pragma once

#include "chimera/base/time.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

/// A ring before the wait ends it at once, as with a Doorbell.
class DescriptorBell {
 public:
  /// Context: setup.
  DescriptorBell() noexcept;

  /// Wakes the sleeper, or whoever waits next. Context: cycle; wait-free (one system call).
  void ring() noexcept;
  /// Waits until `descriptor` is readable, has failed or is closed, and says so; false when it rang or `instant` on
  /// CLOCK_MONOTONIC (kNever: without end) has come. Context: cycle; blocks.
  bool await(int descriptor, Nanoseconds instant) noexcept;

 private:
  OwnedDescriptor event_;
};

}  // namespace chimera
