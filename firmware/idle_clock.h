// SPDX-License-Identifier: Apache-2.0
// The clock of the executive in an image. Between two jobs it serves the watchdog at each tick, and the shell while no
// job is ready.
#pragma once

#include "chimera/base/mechanisms.h"
#include "chimera/platform/bare/bare_clock.h"
#include "chimera/platform/clock.h"
#include "firmware/shell/shell.h"
#include "firmware/watch/watchdog.h"

namespace chimera::firmware {

/// The parts that the clock serves; null: the image has no such part. All of them outlive it.
struct IdleWork {
  Watchdog* watchdog = nullptr;
  ShellListener* listener = nullptr;  ///< beside `shell`
  Shell* shell = nullptr;
};

/// Context of everything not marked: between jobs.
class IdleClock final : public Clock {
 public:
  /// `clock` outlives this. Context: setup.
  explicit IdleClock(bare::BareClock& clock) noexcept : clock_(clock) {}
  /// From now on serves these. Context: setup.
  void serve(const IdleWork& served) noexcept {
    served_ = served;
    next_tick_ = clock_.last_tick();
  }

  Nanoseconds now() noexcept override {
    const Nanoseconds now = clock_.now();
    if (mechanisms::kWatchdog && now >= next_tick_) [[unlikely]] tick(now);
    return now;
  }
  /// Ends early when a line asks for a cycle boundary. The piece of the shell that is under way is finished.
  WaitEnd wait_until(Nanoseconds instant) noexcept override;

 private:
  void tick(Nanoseconds now) noexcept;

  bare::BareClock& clock_;
  IdleWork served_;
  Nanoseconds next_tick_ = kNever;
};

}  // namespace chimera::firmware
