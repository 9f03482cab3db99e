// SPDX-License-Identifier: Apache-2.0
// The clock of a real-time unit: reads the cycle counter, waits on the unit's bell, so that whoever rings it ends
// the wait.
#pragma once

#include "chimera/platform/doorbell.h"
#include "chimera/rtpu/rtpu_control.h"
#include "chimera/runtime/executive/counter_clock.h"

namespace chimera {

/// Used by the thread that cycles only.
class BellClock final : public Clock {
 public:
  /// Context: setup; blocks about 10 ms.
  BellClock(Doorbell bell, std::atomic<std::uint32_t>& running, RtpuControl& edge) noexcept
      : bell_(bell), running_(running), edge_(edge) {}

  Nanoseconds now() noexcept override { return counter_.now(); }
  WaitEnd wait_until(Nanoseconds instant) noexcept override {
    running_.store(0, std::memory_order_relaxed);
    edge_.show_profiles();
    const WaitEnd end = bell_.wait_until(edge_.heard(), instant);
    counter_.compare();
    return end;
  }

 private:
  Doorbell bell_;
  std::atomic<std::uint32_t>& running_;  // BlockHead::running; relaxed, pairs with nothing
  RtpuControl& edge_;
  CounterClock counter_;
};

}  // namespace chimera
