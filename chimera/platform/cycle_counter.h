// SPDX-License-Identifier: Apache-2.0
// Reads CLOCK_MONOTONIC through the processor's cycle counter where the counter is sound: a few nanoseconds a read.
#pragma once

#include <cstdint>

#include "chimera/base/fixed.h"
#include "chimera/base/time.h"

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace chimera {

/// Converts ticks to nanoseconds; repeated comparisons keep the result near a reference clock. Never steps back: when
/// the scale is ahead of the reference, it runs slower until the next comparison, by 1/1024: twice what NTP may slew.
/// Context: cycle; wait-free.
class TickScale {
 public:
  /// `ns_per_2_32_ticks` is the rate, nanoseconds for 2^32 ticks.
  TickScale(std::uint64_t ticks, Nanoseconds at, std::uint64_t ns_per_2_32_ticks) noexcept
      : ticks_(ticks), at_(at), true_rate_(ns_per_2_32_ticks), rate_(ns_per_2_32_ticks) {}

  Nanoseconds at(std::uint64_t ticks) const noexcept {
    const auto gone = static_cast<std::int64_t>(ticks - ticks_);
    if (gone < 0) return at_;  // the counter of another CPU may be a few ticks behind
    __extension__ using Wide = unsigned __int128;
    return {at_.count + static_cast<std::int64_t>((static_cast<Wide>(gone) * rate_) >> 32)};
  }
  /// Sets the scale by `ticks` and `reference`, which the caller read together.
  void compare(std::uint64_t ticks, Nanoseconds reference) noexcept {
    const Nanoseconds mine = at(ticks);
    const bool ahead = mine > reference;
    ticks_ = ticks;
    at_ = ahead ? mine : reference;
    rate_ = ahead ? true_rate_ - true_rate_ / 1024 : true_rate_;
  }

 private:
  std::uint64_t ticks_;
  Nanoseconds at_;
  std::uint64_t true_rate_;
  std::uint64_t rate_;
};

/// A cheap now() on the time line of LinuxClock. One per thread; not shared.
class CycleCounter {
 public:
  /// Measures the counter's rate for about 10 ms. Falls back to clock_gettime if the counter is not invariant
  /// (constant_tsc, nonstop_tsc, rdtscp) or the kernel itself does not trust it. Context: setup; blocks.
  static CycleCounter calibrate() noexcept;

  /// Context: cycle; wait-free.
  Nanoseconds now() const noexcept {
#if defined(__x86_64__)
    if (source_ == Source::kCycleCounter) {
      unsigned cpu;
      return scale_.at(__rdtscp(&cpu));
    }
#endif
    return read_clock();
  }
  /// Sets the counter by CLOCK_MONOTONIC again. Call compare() at least once a second, best after a wait: NTP slews
  /// CLOCK_MONOTONIC, but not the counter, by up to 500 us a second. Context: cycle; wait-free.
  void compare() noexcept;

  /// "cycle counter at 2000 MHz" or "clock_gettime (clock source is hpet, not tsc)". Context: setup.
  const char* describe() const noexcept { return text_.c_str(); }

 private:
  enum class Source : std::uint8_t { kCycleCounter, kClockGettime };

  CycleCounter(Source source, TickScale scale, FixedString<120> text) noexcept
      : source_(source), scale_(scale), text_(text) {}
  static Nanoseconds read_clock() noexcept;

  Source source_;
  TickScale scale_;
  FixedString<120> text_;
};

}  // namespace chimera
