// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "chimera/platform/clock.h"
#include "chimera/platform/cycle_counter.h"

namespace chimera {

/// The clock of the executive: reads the processor's cycle counter where that is sound, waits on CLOCK_MONOTONIC,
/// and sets the one by the other after each wait.
class CounterClock final : public Clock {
 public:
  /// Context: setup; blocks about 10 ms.
  CounterClock() noexcept : counter_(CycleCounter::calibrate()), compared_(counter_.now()) {}

  Nanoseconds now() noexcept override {
    const Nanoseconds t = counter_.now();
    if (t - compared_ > milliseconds(500)) compare();  // a context that never waits
    return t;
  }
  WaitEnd wait_until(Nanoseconds instant) noexcept override {
    const WaitEnd end = waits_.wait_until(instant);
    compare();
    return end;
  }
  const char* describe() const noexcept { return counter_.describe(); }
  /// After a wait by other means. Context: cycle; wait-free.
  void compare() noexcept {
    counter_.compare();
    compared_ = counter_.now();
  }

 private:
  CycleCounter counter_;
  LinuxClock waits_;
  Nanoseconds compared_;
};

}  // namespace chimera
