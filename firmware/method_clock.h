// SPDX-License-Identifier: Apache-2.0
// The clock of methods in an image. Before the run it strokes the watchdog between two methods.
#pragma once

#include "chimera/base/mechanisms.h"
#include "chimera/runtime/job/job_clock.h"
#include "firmware/boards/board.h"

namespace chimera::firmware {

/// Context: cycle.
class MethodClock final : public JobClock {
 public:
  /// The runtime reads the clock before and after `init` and `on`: a method that hangs is not stroked for.
  Nanoseconds now() noexcept override {
    if (mechanisms::kWatchdog && is_setup_) [[unlikely]] board_watchdog().stroke();
    return board_clock().now();
  }
  void spend(Nanoseconds time) noexcept override {
    const Nanoseconds end = board_clock().now() + time;
    while (board_clock().now() < end) {
    }
  }
  /// From now on Watchdog strokes. Context: setup.
  void end_setup() noexcept { is_setup_ = false; }

 private:
  bool is_setup_ = true;
};

}  // namespace chimera::firmware
