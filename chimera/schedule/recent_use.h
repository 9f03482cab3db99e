// SPDX-License-Identifier: Apache-2.0
// For how long something was in use within the time that ends now, as the kernel counts what real-time threads use of
// a processor: it takes the processor from all of them when that is too much.
#pragma once

#include <array>
#include <cstddef>

#include "chimera/base/time.h"

namespace chimera {

/// Exact to a hundredth of the window. Time does not go back from call to call. Context: cycle; wait-free, O(1) on the
/// average, O(kBins) at most, no allocation.
class RecentUse {
 public:
  static constexpr std::size_t kBins = 100;

  /// Requires: window >= 100 ns.
  explicit constexpr RecentUse(Nanoseconds window) noexcept : bin_{window.count / static_cast<std::int64_t>(kBins)} {}

  /// It is in use from `now` on, or it is not.
  constexpr void set(bool in_use, Nanoseconds now) noexcept {
    pass(now);
    in_use_ = in_use;
  }
  /// Within the window that ends at `now`.
  constexpr Nanoseconds used(Nanoseconds now) noexcept {
    pass(now);
    const std::int64_t oldest = bins_[(at_ + 1) % bins_.size()].count;
    return {total_.count - oldest * (bin_.count - (end_ - now).count) / bin_.count};  // what of it has left the window
  }

 private:
  constexpr void pass(Nanoseconds now) noexcept {
    if (now >= end_ + bin_ * static_cast<std::int64_t>(kBins)) return start_over(now);
    while (now >= end_) {
      add(end_);
      open_next_bin();
    }
    add(now);
  }
  // Whatever it was for the whole of the window, it was that all the time.
  constexpr void start_over(Nanoseconds now) noexcept {
    const Nanoseconds each = in_use_ ? bin_ : Nanoseconds{};
    bins_.fill(each);
    bins_[at_] = {};
    total_ = each * static_cast<std::int64_t>(kBins);
    last_ = now;
    end_ = now + bin_;
  }
  constexpr void add(Nanoseconds now) noexcept {
    if (in_use_) bins_[at_] += now - last_, total_ += now - last_;
    last_ = now;
  }
  constexpr void open_next_bin() noexcept {
    at_ = (at_ + 1) % bins_.size();
    total_ = total_ - bins_[at_];
    bins_[at_] = {};
    end_ += bin_;
  }

  Nanoseconds bin_;
  std::array<Nanoseconds, kBins + 1> bins_{};  // the present one, and those before it
  std::size_t at_ = 0;
  Nanoseconds total_;                          // of all bins
  Nanoseconds last_, end_;                     // counted up to here; of the present bin
  bool in_use_ = false;
};

}  // namespace chimera
