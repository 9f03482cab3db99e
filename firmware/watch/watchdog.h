// SPDX-License-Identifier: Apache-2.0
// Strokes the watchdog of the chip while the tasks live.
#pragma once

#include "firmware/watch/reset_record.h"
#include "firmware/watch/vitals.h"

namespace chimera::firmware {

/// The watchdog of the chip.
class WatchdogPort {
 public:
  /// Begins the time anew after which the watchdog interrupts, and then resets. Context: any; wait-free.
  virtual void stroke() noexcept = 0;

 protected:
  ~WatchdogPort() = default;
};

/// Context of everything not marked: between jobs; wait-free.
class Watchdog {
 public:
  /// After this healthy time the run ends the row of warm boots.
  static constexpr Nanoseconds kSettled = seconds(10);

  /// All outlive this. Context: setup.
  Watchdog(Vitals& vitals, WatchdogPort& port, ResetRecord& record) noexcept
      : vitals_(vitals), port_(port), record_(record) {}

  /// Call it once a tick: strokes, or keeps in the record why not.
  void tick(Nanoseconds now) noexcept {
    last_ = vitals_.look(now);
    if (!last_.is_healthy()) {
      if (healthy_since_ != kNever || !was_looked_at_) note_vital_fault(record_, last_);
      healthy_since_ = kNever;
      was_looked_at_ = true;
      return;
    }
    was_looked_at_ = true;
    port_.stroke();
    if (healthy_since_ == kNever) {
      healthy_since_ = now;
      forget_vital_fault(record_);
    }
    if (!is_settled_ && now - healthy_since_ >= kSettled) {
      is_settled_ = true;
      note_settled(record_);
    }
  }
  /// Result of the last tick.
  const VitalAnswer& last() const noexcept { return last_; }

 private:
  Vitals& vitals_;
  WatchdogPort& port_;
  ResetRecord& record_;
  Nanoseconds healthy_since_ = kNever;  // kNever: not healthy at the last tick
  VitalAnswer last_;
  bool is_settled_ = false;
  bool was_looked_at_ = false;
};

}  // namespace chimera::firmware
