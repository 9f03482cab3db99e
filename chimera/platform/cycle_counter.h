// SPDX-License-Identifier: Apache-2.0
// CLOCK_MONOTONIC read through the processor's cycle counter where that is sound: a few nanoseconds a read.
#pragma once

#include <cstdint>

#include "chimera/base/fixed.h"
#include "chimera/base/time.h"

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace chimera {

/// From ticks to nanoseconds, held to a reference clock by now and then comparing. Never steps back: when it is
/// ahead of the reference it goes slower (by 1/1024, twice what NTP may slew) until the next comparison.
/// Context: cycle; wait-free.
class TickScale {
 public:
  /// `ns_per_2_32_ticks` is the rate, nanoseconds for 2^32 ticks.
  TickScale(std::uint64_t ticks, Nanoseconds at, std::uint64_t ns_per_2_32_ticks) noexcept
      : ticks_(ticks), at_(at), true_rate_(ns_per_2_32_ticks), rate_(ns_per_2_32_ticks) {}

  Nanoseconds at(std::uint64_t ticks) const noexcept {
    const auto gone = static_cast<std::int64_t>(ticks - ticks_);
    if (gone < 0) return at_;  // another CPU's counter, a hair behind
    __extension__ using Wide = unsigned __int128;
    return {at_.count + static_cast<std::int64_t>((static_cast<Wide>(gone) * rate_) >> 32)};
  }
  /// `ticks` and `reference` were read together.
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
  enum class Source : std::uint8_t { kCycleCounter, kClockGettime };

  /// Measures the counter's rate for about 10 ms; falls back to clock_gettime where the counter is not invariant
  /// (constant_tsc, nonstop_tsc, rdtscp) or the kernel itself does not trust it. Context: setup; blocks.
  static CycleCounter calibrate() noexcept;
  /// As calibrate(), with the fallback forced: for comparison.
  static CycleCounter by_clock_gettime() noexcept;

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
  /// Sets the counter by CLOCK_MONOTONIC again. At least once a second, best after a wait: NTP slews the one and
  /// not the other by up to 500 us a second. Context: cycle; wait-free.
  void compare() noexcept;

  Source source() const noexcept { return source_; }
  /// "cycle counter at 2000 MHz" or "clock_gettime (clock source is hpet, not tsc)". Context: setup.
  const char* describe() const noexcept { return text_.c_str(); }

 private:
  CycleCounter(Source source, TickScale scale, FixedString<120> text) noexcept
      : source_(source), scale_(scale), text_(text) {}
  static Nanoseconds read_clock() noexcept;

  Source source_;
  TickScale scale_;
  FixedString<120> text_;
};

}  // namespace chimera
