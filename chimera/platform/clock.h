// SPDX-License-Identifier: Apache-2.0
// Time and waiting behind one interface: linux/ waits in the kernel, virtual/ steps to the instant at once.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"

namespace chimera {

/// Why a wait ended.
enum class WaitEnd : std::uint8_t {
  kReached,  ///< now() is at or after the instant
  kWoken,    ///< earlier: somebody wants attention (Linux: a signal was handled; virtual: wake_at)
};

/// A clock that never goes backwards, and a wait for an instant on it.
class Clock {
 public:
  /// Context: cycle; wait-free.
  virtual Nanoseconds now() noexcept = 0;
  /// Waits until `instant`, an absolute time on this clock: a loop that adds its period to the instant does not
  /// drift. An instant in the past is reached at once. Context: cycle; blocks.
  virtual WaitEnd wait_until(Nanoseconds instant) noexcept = 0;

 protected:
  ~Clock() = default;
};

}  // namespace chimera
