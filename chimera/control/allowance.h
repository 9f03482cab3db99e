// SPDX-License-Identifier: Apache-2.0
// A token bucket: so many a second on average, so many at once.
#pragma once

#include <algorithm>
#include <cstdint>

#include "chimera/base/time.h"

namespace chimera::control {

/// Time is given, never read. Context: any.
class Allowance {
 public:
  constexpr Allowance(std::int64_t per_second, std::int64_t burst) noexcept
      : Allowance(Nanoseconds{1'000'000'000 / per_second}, burst) {}
  constexpr Allowance(Nanoseconds interval, std::int64_t burst) noexcept
      : interval_(interval), burst_(burst), left_(burst) {}

  /// Takes `n`, at most the burst; takes nothing and is false when there are not so many left at `now`.
  constexpr bool try_take(Nanoseconds now, std::int64_t n = 1) noexcept {
    if (now > filled_) {
      const std::int64_t gained = (now - filled_).count / interval_.count;
      left_ = std::min(burst_, left_ + std::min(burst_, gained));
      filled_ = left_ == burst_ ? now : filled_ + interval_ * gained;
    }
    if (left_ < n) return false;
    left_ -= n;
    return true;
  }
  /// After try_take(now, n) said no: how long until it will not.
  constexpr Nanoseconds wait(Nanoseconds now, std::int64_t n = 1) const noexcept {
    return left_ >= n ? Nanoseconds{} : interval_ * (n - left_) - (now - filled_);
  }

 private:
  Nanoseconds interval_;
  std::int64_t burst_, left_;
  Nanoseconds filled_;
};

}  // namespace chimera::control
