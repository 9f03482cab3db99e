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
      : interval_{1'000'000'000 / per_second}, burst_(burst), left_(burst) {}

  /// Takes one; false when there is none left at `now`.
  constexpr bool take(Nanoseconds now) noexcept {
    if (now > filled_) {
      const std::int64_t gained = (now - filled_).count / interval_.count;
      left_ = std::min(burst_, left_ + gained);
      filled_ = left_ == burst_ ? now : filled_ + interval_ * gained;
    }
    if (left_ == 0) return false;
    --left_;
    return true;
  }
  /// How long until there is one again.
  constexpr Nanoseconds wait(Nanoseconds now) const noexcept {
    return left_ > 0 ? Nanoseconds{} : interval_ - (now - filled_);
  }

 private:
  Nanoseconds interval_;
  std::int64_t burst_, left_;
  Nanoseconds filled_;
};

}  // namespace chimera::control
