// SPDX-License-Identifier: Apache-2.0
// Elementary functions for components. They use IEEE additions, multiplications, divisions and square roots in a fixed
// order. So a host and a microcontroller give the same bits, which two C libraries do not.
//
// Errors are the largest found against a reference of higher precision, in units in the last place; math_test.cc checks
// them. All functions: Context: any; wait-free; no errno, no promise about exception flags. NaN in, NaN out.
#pragma once

#include <bit>
#include <cstdint>

namespace chimera::math {

struct SinCos {
  double sin = 0;
  double cos = 0;
};

/// Below 1 ulp for |x| <= 1e6. Beyond, as if x were off by less than half its own last place. Infinity gives NaN.
double sin(double x) noexcept;
double cos(double x) noexcept;
/// Both at the price of little more than one.
SinCos sincos(double x) noexcept;
/// Below 2.1 ulp for |x| <= 1e6.
double tan(double x) noexcept;

/// Below 1 ulp.
double atan(double x) noexcept;
/// Angle of the point (x, y) in [-pi, pi], all signs of zero and infinity as in IEEE 754. Below 2 ulp.
double atan2(double y, double x) noexcept;
/// NaN outside [-1, 1]. Below 1.2 ulp.
double asin(double x) noexcept;
/// NaN outside [-1, 1]. Below 1 ulp.
double acos(double x) noexcept;

/// Below 1 ulp. Overflows to infinity above 709.78, underflows to 0 below -745.13.
/// 1 ulp where the result is subnormal.
double exp(double x) noexcept;
/// Natural. -infinity at 0, NaN below. Below 1 ulp.
double log(double x) noexcept;

/// Correctly rounded. NaN below 0.
double sqrt(double x) noexcept;
/// sqrt(x*x + y*y) without overflow on the way. Below 2 ulp.
double hypot(double x, double y) noexcept;
/// Exact: x minus the whole multiple of y that leaves the sign of x. NaN when y is 0 or x is infinite.
/// At most 2100 steps.
double fmod(double x, double y) noexcept;

// Defined in the header, because cycles call these functions for each element.
inline constexpr std::uint64_t kSignBit = std::uint64_t{1} << 63;
inline constexpr std::uint64_t kInfinityBits = std::uint64_t{0x7ff} << 52;

constexpr bool is_nan(double x) noexcept { return (std::bit_cast<std::uint64_t>(x) & ~kSignBit) > kInfinityBits; }
constexpr bool is_finite(double x) noexcept { return (std::bit_cast<std::uint64_t>(x) & ~kSignBit) < kInfinityBits; }
constexpr double fabs(double x) noexcept { return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & ~kSignBit); }
constexpr double copysign(double magnitude, double sign) noexcept {
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(magnitude) & ~kSignBit) |
                               (std::bit_cast<std::uint64_t>(sign) & kSignBit));
}
constexpr double floor(double x) noexcept {
  if (!(fabs(x) < 0x1p52)) return x;  // whole already, infinite, or NaN
  const auto cut = static_cast<double>(static_cast<std::int64_t>(x));
  return copysign(cut > x ? cut - 1 : cut, x);
}
constexpr double ceil(double x) noexcept { return -floor(-x); }
/// The nearest whole number; halves go away from 0.
constexpr double round(double x) noexcept {
  const double below = floor(fabs(x));
  return copysign(fabs(x) - below >= 0.5 ? below + 1 : below, x);
}

inline constexpr double kPi = 0x1.921fb54442d18p+1;

}  // namespace chimera::math
