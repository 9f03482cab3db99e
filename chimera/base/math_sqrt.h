// SPDX-License-Identifier: Apache-2.0
// The square root, correctly rounded. Uses the instruction of the processor if it has one, and computes bit by bit
// otherwise. Both give the same bits, because only one correctly rounded result exists.
#pragma once

#include <bit>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace chimera::math {

/// One bit of the root at a time, as on paper. Context: any; wait-free; 54 steps.
inline double sqrt_bit_by_bit(double x) noexcept {
  constexpr std::uint64_t kHidden = std::uint64_t{1} << 52;
  const auto b = std::bit_cast<std::uint64_t>(x);
  if (x == 0 || b == 0x7ff0000000000000) return x;
  if (!(x > 0)) return __builtin_nan("");
  auto exponent = static_cast<int>(b >> 52);
  std::uint64_t m = b & (kHidden - 1);
  if (exponent == 0) {
    for (exponent = 1; m < kHidden; --exponent) m <<= 1;
  } else {
    m |= kHidden;
  }
  int e = exponent - 1023;
  if (e & 1) {
    m <<= 1;
    --e;
  }
  // root = floor(sqrt(m * 2^54)): 54 bits, the last one for rounding. Two bits of m enter in each step.
  std::uint64_t root = 0, rest = 0;
  for (int step = 0; step < 54; ++step) {
    const std::uint64_t two = step < 27 ? (m >> (52 - 2 * step)) & 3 : 0;
    rest = rest << 2 | two;
    root <<= 1;
    if (rest > 2 * root) {
      rest -= 2 * root + 1;
      root += 1;
    }
  }
  // A tie cannot occur: the square of a number ending in a half bit has more bits than m.
  const std::uint64_t rounded = (root >> 1) + (root & 1);
  return std::bit_cast<double>((static_cast<std::uint64_t>(e / 2 + 1023) << 52) + (rounded - kHidden));
}

inline double sqrt_of_the_machine(double x) noexcept {
#if defined(__SSE2__)
  const __m128d v = _mm_set_sd(x);
  return _mm_cvtsd_f64(_mm_sqrt_sd(v, v));
#else
  return sqrt_bit_by_bit(x);
#endif
}

}  // namespace chimera::math
