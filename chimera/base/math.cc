// SPDX-License-Identifier: Apache-2.0
// Reduces arguments exactly, evaluates minimax polynomials, and puts the parts together in a fixed order of
// operations.
#include "chimera/base/math.h"

#include <bit>
#include <cstddef>
#include <cstdint>

#include "chimera/base/math_coefficients.h"
#include "chimera/base/math_sqrt.h"

namespace chimera::math {
namespace {

constexpr std::uint64_t kMantissa = (std::uint64_t{1} << 52) - 1;
constexpr double kInfinity = __builtin_inf();
constexpr double kNan = __builtin_nan("");

std::uint64_t bits(double x) noexcept { return std::bit_cast<std::uint64_t>(x); }
double from_bits(std::uint64_t b) noexcept { return std::bit_cast<double>(b); }
bool is_negative(double x) noexcept { return (bits(x) & kSignBit) != 0; }

template <std::size_t N>
double polynomial(const double (&c)[N], double x) noexcept {
  double sum = c[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// A number as the unevaluated sum of two doubles.
struct Pair {
  double hi, lo;
};

Pair two_sum(double a, double b) noexcept {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

// x = quadrant * pi/2 + rest, |rest| <= pi/4. The quadrant counts modulo 4.
struct Reduced {
  int quadrant;
  Pair rest;
};

constexpr double kReductionLimit = 1e6;  // times pi/2; the quadrant stays below 2^20: products with it are exact

Reduced reduce(double x) noexcept {
  if (fabs(x) <= kPiHi / 4) return {0, {x, 0}};
  if (fabs(x) > kReductionLimit) x = fmod(x, 2 * kPiHi);
  const double scaled = x * kTwoOverPi;
  const auto n = static_cast<int>(scaled + (scaled < 0 ? -0.5 : 0.5));
  const double dn = n;
  const Pair first = two_sum(x - dn * kHalfPiFirst, -(dn * kHalfPiSecond));
  const Pair second = two_sum(first.hi, -(dn * kHalfPiThird));
  const double tail = first.lo + second.lo - dn * kHalfPiFourth;
  const double hi = second.hi + tail;
  return {n & 3, {hi, (second.hi - hi) + tail}};
}

// sin(hi + lo) = x + x^3 P(x^2), with the derivative cos(hi) ~ 1 - z/2 for lo.
double kernel_sin(Pair x) noexcept {
  const double z = x.hi * x.hi;
  const double cube = z * x.hi;
  return x.hi + (cube * polynomial(kSin, z) + (x.lo - 0.5 * z * x.lo));
}

// cos(hi + lo) = 1 - z/2 + z^2 P(z) - hi*lo. The sum adds back the rounding error of 1 - z/2.
double kernel_cos(Pair x) noexcept {
  const double z = x.hi * x.hi;
  const double half = 0.5 * z;
  const double head = 1 - half;
  return head + (((1 - head) - half) + (z * z * polynomial(kCos, z) - x.hi * x.lo));
}

// atan(t) for |t| <= 3/16, without its leading t.
double atan_rest(double t) noexcept {
  const double z = t * t;
  return t * z * polynomial(kAtan, z);
}

// atan(x) as a pair, 0 <= x <= 1: from the nearest multiple of 1/8.
Pair atan_of_unit(double x) noexcept {
  if (x < 3.0 / 16) return {x, atan_rest(x)};
  const auto k = static_cast<int>(x * 8 + 0.5);  // NOLINT: either neighbour of a half will do
  const double c = k * 0.125;
  const double t = (x - c) / (1 + c * x);
  return {kAtanOfEighths[k].hi, kAtanOfEighths[k].lo + atan_rest(t) + t};
}

// (asin(x) - x) / x for |x| <= 1/2, z = x^2.
double asin_rest(double z) noexcept { return z * polynomial(kAsin, z); }

// The square root of z with its rounding error. The callers subtract 2 * sqrt from an angle, so the error counts.
Pair sqrt_pair(double z) noexcept {
  if (z == 0) return {0, 0};
  const double s = sqrt(z);
  const double head = from_bits(bits(s) & ~std::uint64_t{0xffffffff});  // its square is exact
  return {head, (z - head * head) / (s + head)};
}

}  // namespace

double sqrt(double x) noexcept { return sqrt_of_the_machine(x); }

double fmod(double x, double y) noexcept {
  if (!is_finite(x) || is_nan(y) || y == 0) return kNan;
  std::uint64_t a = bits(x) & ~kSignBit;
  const std::uint64_t b = bits(y) & ~kSignBit;
  if (a < b) return x;
  // Mantissas as whole numbers, exponents counted from the smallest subnormal.
  auto split = [](std::uint64_t v, int& exponent) {
    exponent = static_cast<int>(v >> 52);
    if (exponent == 0) return exponent = 1, v;
    return (v & kMantissa) | (kMantissa + 1);
  };
  int ea = 0, eb = 0;
  std::uint64_t ma = split(a, ea);
  const std::uint64_t mb = split(b, eb);
  for (ma %= mb; ea > eb && ma != 0; --ea) ma = (ma << 1) % mb;
  if (ma == 0) return copysign(0, x);
  for (ea = eb; ma <= kMantissa && ea > 1; --ea) ma <<= 1;
  a = ma > kMantissa ? (ma & kMantissa) | (static_cast<std::uint64_t>(ea) << 52) : ma;
  return copysign(from_bits(a), x);
}

double sin(double x) noexcept {
  if (fabs(x) < 0x1p-27) return x;  // keeps the sign of zero
  if (!is_finite(x)) return kNan;
  const Reduced r = reduce(x);
  const double value = (r.quadrant & 1) == 0 ? kernel_sin(r.rest) : kernel_cos(r.rest);
  return r.quadrant < 2 ? value : -value;
}

double cos(double x) noexcept {
  if (!is_finite(x)) return kNan;
  const Reduced r = reduce(x);
  const double value = (r.quadrant & 1) == 0 ? kernel_cos(r.rest) : kernel_sin(r.rest);
  return r.quadrant == 0 || r.quadrant == 3 ? value : -value;
}

SinCos sincos(double x) noexcept {
  if (!is_finite(x)) return {kNan, kNan};
  const Reduced r = reduce(x);
  const double s = fabs(x) < 0x1p-27 ? x : kernel_sin(r.rest);
  const double c = kernel_cos(r.rest);
  switch (r.quadrant) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

double tan(double x) noexcept {
  const SinCos both = sincos(x);
  return both.sin / both.cos;
}

double atan(double x) noexcept {
  if (is_nan(x)) return x;
  const double a = fabs(x);
  if (a < 0x1p-27) return x;
  if (a <= 1) {
    const Pair angle = atan_of_unit(a);
    return copysign(angle.hi + angle.lo, x);
  }
  const Pair angle = atan_of_unit(1 / a);
  return copysign(kHalfPiHi - (angle.hi - (kHalfPiLo - angle.lo)), x);
}

double atan2(double y, double x) noexcept {
  if (is_nan(x) || is_nan(y)) return kNan;
  const bool behind = is_negative(x);
  double angle = 0;  // of (|x|, |y|), in the first quadrant
  if (y == 0) {
    angle = 0;
  } else if (x == 0) {
    angle = kHalfPiHi;
  } else if (!is_finite(x) && !is_finite(y)) {
    angle = kPiHi / 4;
  } else {
    angle = atan(fabs(y / x));
  }
  return copysign(behind ? kPiHi - (angle - kPiLo) : angle, y);
}

double asin(double x) noexcept {
  const double a = fabs(x);
  if (!(a <= 1)) return kNan;
  if (a < 0x1p-27) return x;
  if (a <= 0.5) return x + x * asin_rest(x * x);
  const double z = (1 - a) * 0.5;
  const Pair s = sqrt_pair(z);
  const double small = 2 * ((s.hi + s.lo) * asin_rest(z) + s.lo) - kHalfPiLo;
  return copysign(kHalfPiHi - (2 * s.hi + small), x);
}

double acos(double x) noexcept {
  if (!(fabs(x) <= 1)) return kNan;
  if (fabs(x) <= 0.5) return kHalfPiHi - (x - (kHalfPiLo - x * asin_rest(x * x)));
  const double z = (1 - fabs(x)) * 0.5;
  const Pair s = sqrt_pair(z);
  const double rest = (s.hi + s.lo) * asin_rest(z) + s.lo;
  if (x > 0) return 2 * (s.hi + rest);
  return kPiHi - 2 * (s.hi + (rest - kHalfPiLo));
}

double exp(double x) noexcept {
  if (is_nan(x)) return x;
  if (x > 709.782712893384) return kInfinity;
  if (x < -745.1332191019412) return 0;
  const double scaled = x * kOneOverLn2;
  const auto k = static_cast<int>(scaled + (scaled < 0 ? -0.5 : 0.5));
  const double hi = x - k * kLn2Hi;  // exact: kLn2Hi has 33 bits
  const double lo = k * kLn2Lo;
  const double r = hi - lo;
  const double value = 1 + (hi + (r * r * polynomial(kExp, r) - lo));
  // 2^k in two factors: the first keeps the value normal, the second may round it into the subnormals, once.
  const int half = k / 2;
  const auto power = [](int e) { return from_bits(static_cast<std::uint64_t>(e + 1023) << 52); };
  return value * power(half) * power(k - half);
}

double log(double x) noexcept {
  if (is_nan(x) || x == kInfinity) return x;
  if (x == 0) return -kInfinity;
  if (x < 0) return kNan;
  int k = 0;
  if (x < 0x1p-1022) {
    x *= 0x1p54;
    k = -54;
  }
  // x = 2^k m with m in [sqrt(1/2), sqrt(2)). Subtracts the high word of sqrt(1/2) before it reads the exponent.
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e667f3bcd;
  const auto exponent = static_cast<std::int64_t>(bits(x) - kRootHalf) >> 52;
  k += static_cast<int>(exponent);
  const double m = from_bits(bits(x) - (static_cast<std::uint64_t>(exponent) << 52));
  const double f = m - 1;
  const double s = f / (2 + f);
  const double z = s * s;
  const double half_square = 0.5 * f * f;
  // log(1+f) = f - f^2/2 + s (f^2/2 + z P(z)), from 2 artanh(s) with 2s = f - s f.
  const double rest = s * (half_square + z * polynomial(kLog, z));
  return k * kLn2Hi - ((half_square - (rest + k * kLn2Lo)) - f);
}

double hypot(double x, double y) noexcept {
  double a = fabs(x), b = fabs(y);
  if (a == kInfinity || b == kInfinity) return kInfinity;
  if (a < b) {
    const double swap = a;
    a = b;
    b = swap;
  }
  if (!(b >= a * 0x1p-60)) return a + b;  // too small to count, or NaN
  double scale = 1;
  if (a > 0x1p500) scale = 0x1p-600;
  if (b < 0x1p-500) scale = 0x1p600;
  a *= scale;
  b *= scale;
  return sqrt(a * a + b * b) / scale;
}

}  // namespace chimera::math
