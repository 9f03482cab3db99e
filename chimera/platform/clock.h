// SPDX-License-Identifier: Apache-2.0
// Time and waiting behind one interface, for Linux and for virtual time.
#pragma once

#include <cstdint>

#include "chimera/base/assert.h"
#include "chimera/base/time.h"

namespace chimera {

/// Why a wait ended.
enum class WaitEnd : std::uint8_t {
  kReached,  ///< now() is at or after the instant
  kWoken,    ///< the wait ended early (LinuxClock: a signal was handled)
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

/// CLOCK_MONOTONIC. A wait ends early when a signal handler runs in the waiting thread. A signal that is handled just
/// before the wait begins does not end the wait: a flag that a handler sets is seen at most one wait later.
class LinuxClock final : public Clock {
 public:
  Nanoseconds now() noexcept override;
  WaitEnd wait_until(Nanoseconds instant) noexcept override;
};

/// Time that passes by a wait or by advance() only. Asks for no operating system.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(Nanoseconds start = {}) noexcept : now_(start) {}

  // Not inline: the compiler would guess this clock in the loop of the executive, which never runs on it in real time.
  Nanoseconds now() noexcept override;
  /// Steps to `instant` at once.
  WaitEnd wait_until(Nanoseconds instant) noexcept override;
  /// Lets `span` pass, as when a job computes. Requires: span >= 0. Context: any; wait-free.
  void advance(Nanoseconds span) noexcept {
    CHIMERA_ASSERT(span.count >= 0);
    now_ += span;
  }

 private:
  Nanoseconds now_;
};

/// CLOCK_REALTIME minus CLOCK_MONOTONIC, in ns. Context: setup.
std::int64_t wall_clock_shift() noexcept;

}  // namespace chimera
