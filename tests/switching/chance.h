// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "chimera/base/time.h"

namespace chimera::simulated {

/// Dice that fall the same way for the same seed on every machine (SplitMix64).
class Chance {
 public:
  explicit Chance(std::uint64_t seed) noexcept : state_(seed * 0x9e3779b97f4a7c15u + 1) {}

  std::uint64_t next() noexcept {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// 0 to n - 1; n > 0.
  std::size_t below(std::size_t n) noexcept { return static_cast<std::size_t>(next() % n); }
  bool percent(unsigned p) noexcept { return below(100) < p; }
  bool permille(unsigned p) noexcept { return below(1000) < p; }
  Nanoseconds between(Nanoseconds from, Nanoseconds to) noexcept {
    return {from.count + static_cast<std::int64_t>(below(static_cast<std::size_t>(to.count - from.count) + 1))};
  }
  template <class T>
  const T& of(const std::vector<T>& list) noexcept { return list[below(list.size())]; }

 private:
  std::uint64_t state_;
};

}  // namespace chimera::simulated
