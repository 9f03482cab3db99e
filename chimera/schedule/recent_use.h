// SPDX-License-Identifier: Apache-2.0
// Measures the time of use within the last `window`, as the kernel counts the use of a processor by real-time threads.
// If they use too much, the kernel takes the processor from all of them.
#pragma once

#include <array>
#include <cstddef>

#include "chimera/base/time.h"

namespace chimera {

/// Exact to a hundredth of the window. Requires: `now` never goes back. Context: cycle; wait-free, O(1) on average,
/// O(kBins) at most, no allocation.
class RecentUse {
 public:
  static constexpr std::size_t kBins = 100;

  /// Requires: window >= 100 ns.
  explicit constexpr RecentUse(Nanoseconds window) noexcept : bin_{window.count / static_cast<std::int64_t>(kBins)} {}

  /// Sets if the processor is in use from `now` on.
  constexpr void set(bool in_use, Nanoseconds now) noexcept {
    pass(now);
    in_use_ = in_use;
  }
  /// The time of use within the window that ends at `now`.
  constexpr Nanoseconds used(Nanoseconds now) noexcept {
    pass(now);
    const std::int64_t oldest = bins_[(at_ + 1) % bins_.size()].count;
    return {total_.count - oldest * (bin_.count - (end_ - now).count) / bin_.count};  // without the expired part
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
  // More than a window has passed: the present state held during all of it.
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
  std::array<Nanoseconds, kBins + 1> bins_{};  // the present bin, and those before it
  std::size_t at_ = 0;
  Nanoseconds total_;                          // of all bins
  Nanoseconds last_, end_;                     // end of the counted time; end of the present bin
  bool in_use_ = false;
};

}  // namespace chimera
