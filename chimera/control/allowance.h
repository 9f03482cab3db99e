// SPDX-License-Identifier: Apache-2.0
// A token bucket: bounds the average rate and the number at once.
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

  /// Takes `n` tokens; `n` is at most the burst. False, and takes none, if fewer than `n` are left at `now`.
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
  /// Time until try_take(now, n) succeeds, after it returned false.
  constexpr Nanoseconds wait(Nanoseconds now, std::int64_t n = 1) const noexcept {
    return left_ >= n ? Nanoseconds{} : interval_ * (n - left_) - (now - filled_);
  }

 private:
  Nanoseconds interval_;
  std::int64_t burst_, left_;
  Nanoseconds filled_;
};

}  // namespace chimera::control
