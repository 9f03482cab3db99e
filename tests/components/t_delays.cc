// SPDX-License-Identifier: Apache-2.0
// How punctual its own cycles are: how long after its release each began, counted, and shown when it goes OFF.
#include <bit>
#include <ctime>

#include "chimera/task/component.h"

using namespace chimera;

struct Delays {
  static constexpr int kBins = 256;
  Out<std::int64_t[kBins]> counts{"counts", initial = 0, doc = "bin b: delays from (16 + b % 16) 2^(b / 16) 16 ns on"};

  void on() {
    for (std::int64_t& n : seen_) n = 0;
  }
  void cycle(Cycle c) {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    const std::int64_t delay = t.tv_sec * 1'000'000'000 + t.tv_nsec - c.now().count;
    ++seen_[bin_of(delay)];
  }
  void off() {
    for (int b = 0; b < kBins; ++b) counts[b] = seen_[b];
  }

  /// Sixteen bins for each doubling, from 256 ns on; what is below or above counts in the first or the last.
  static int bin_of(std::int64_t delay) noexcept {
    if (delay < 256) return 0;
    const auto units = static_cast<std::uint64_t>(delay) / 16;
    const int doublings = static_cast<int>(std::bit_width(units)) - 5;
    const int bin = doublings * 16 + static_cast<int>(units >> doublings) - 16;
    return bin < kBins ? bin : kBins - 1;
  }
  std::int64_t seen_[kBins] = {};
};
CHIMERA_COMPONENT(Delays, "t_delays", "Counts how long after its release each cycle begins.", rate = 1000.0);
