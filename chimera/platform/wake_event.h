// SPDX-License-Identifier: Apache-2.0
// A descriptor that any thread may make readable, for one that waits for several descriptors.
#pragma once

#include "chimera/base/result.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

/// Makes the descriptor of a WakeEvent readable. A number that is not open does nothing. Context: cycle; wait-free (one
/// system call).
void ring_event(int descriptor) noexcept;

/// Rings are not counted: readable since the first of them, until reset(). Movable; closes.
class WakeEvent {
 public:
  WakeEvent() noexcept = default;  ///< never readable
  /// Refuses with the system's reason, said of `what`. Context: setup.
  static Result<WakeEvent> open(const Message& what) noexcept;

  void ring() const noexcept { ring_event(event_.fd); }
  /// Not readable until the next ring. Context: setup; never blocks.
  void reset() const noexcept;
  int descriptor() const noexcept { return event_.fd; }

 private:
  explicit WakeEvent(OwnedDescriptor event) noexcept : event_(std::move(event)) {}
  OwnedDescriptor event_;
};

}  // namespace chimera
