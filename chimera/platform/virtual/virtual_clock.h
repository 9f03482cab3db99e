// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "chimera/platform/clock.h"

namespace chimera {

/// Time that passes only when told: by a wait, or by advance().
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(Nanoseconds start = {}) noexcept : now_(start) {}

  Nanoseconds now() noexcept override { return now_; }
  /// Steps to `instant`, or to an earlier wake_at().
  WaitEnd wait_until(Nanoseconds instant) noexcept override;

  /// Lets `span` pass, as when a job computes. Requires: span >= 0. Context: any; wait-free.
  void advance(Nanoseconds span) noexcept;
  /// The wait during which `instant` comes ends there, once. One wake is pending at a time; a later call
  /// replaces it. Context: any; wait-free.
  void wake_at(Nanoseconds instant) noexcept { wake_ = instant; }

 private:
  Nanoseconds now_;
  Nanoseconds wake_ = kNever;
};

}  // namespace chimera
