// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "chimera/base/math_sqrt.h"

namespace chimera {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr int kPoints = 200'000;

// Knuth's MMIX generator: the same points in every run and on every machine.
class Points {
 public:
  std::uint64_t next() { return state_ = state_ * 6364136223846793005u + 1442695040888963407u; }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double between(double lo, double hi) { return lo + (hi - lo) * unit(); }
  // Spreads points evenly over the exponents: as many near 1e-300 as near 1.
  double any_magnitude(double lo, double hi) {
    const double x = std::exp2(between(std::log2(lo), std::log2(hi)));
    return next() >> 63 ? -x : x;
  }

 private:
  std::uint64_t state_ = 2026;
};

double ulps(double got, long double expected) {
  const double nearest = static_cast<double>(expected);
  if (got == nearest || (std::isnan(got) && std::isnan(nearest))) {
    if (std::isnan(nearest) || std::isinf(nearest)) return 0;
  }
  const int exponent = std::max(std::ilogb(nearest), -1022) - 52;
  return static_cast<double>(std::ldexp(std::fabs(static_cast<long double>(got) - expected), -exponent));
}

template <class Ours, class Reference, class Argument>
double worst(Ours ours, Reference reference, Argument argument) {
  Points points;
  double most = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double x = argument(points);
    most = std::max(most, ulps(ours(x), reference(static_cast<long double>(x))));
  }
  return most;
}

auto range(double lo, double hi) {
  return [=](Points& p) { return p.between(lo, hi); };
}
auto magnitudes(double lo, double hi) {
  return [=](Points& p) { return p.any_magnitude(lo, hi); };
}

TEST(Math, SineAndCosineAreWithinOneUlp) {
  const auto sine = [](long double x) { return std::sin(x); };
  const auto cosine = [](long double x) { return std::cos(x); };
  for (const double end : {0.8, 10.0, 1000.0, 1e6}) {
    EXPECT_LT(worst(math::sin, sine, range(-end, end)), 1) << end;
    EXPECT_LT(worst(math::cos, cosine, range(-end, end)), 1) << end;
  }
  EXPECT_LT(worst(math::sin, sine, magnitudes(1e-300, 1)), 1);
}

TEST(Math, SineIsRightBesideMultiplesOfPi) {
  // The doubles nearest to n pi/2, where nearly everything cancels. The long double library is good to 64 bits there.
  double most = 0;
  for (int n = 1; n <= 600'000; ++n) {
    const double x = static_cast<double>(n * 1.57079632679489661923132169163975144L);
    const math::SinCos both = math::sincos(x);
    const auto wide = static_cast<long double>(x);
    most = std::max(most, n % 2 == 0 ? ulps(both.sin, std::sin(wide)) : ulps(both.cos, std::cos(wide)));
  }
  EXPECT_LT(most, 1);
}

TEST(Math, TangentIsWithinTwoUlpAndATenth) {
  const auto tangent = [](long double x) { return std::tan(x); };
  for (const double end : {1.5, 1000.0, 1e6}) EXPECT_LT(worst(math::tan, tangent, range(-end, end)), 2.1) << end;
}

TEST(Math, SineOfALargeArgumentIsThatOfANeighbour) {
  Points points;
  for (int i = 0; i < 20'000; ++i) {
    const double x = points.any_magnitude(1e6, 1e15);
    const long double slack = 0.51L * std::ldexp(1.0L, std::ilogb(x) - 52);
    const long double error = std::fabs(math::sin(x) - std::sin(static_cast<long double>(x)));
    ASSERT_LE(error, slack + 0x1p-52L) << x;
  }
}

TEST(Math, ArcTangentIsWithinOneUlp) {
  const auto reference = [](long double x) { return std::atan(x); };
  EXPECT_LT(worst(math::atan, reference, range(-2, 2)), 1);
  EXPECT_LT(worst(math::atan, reference, magnitudes(1e-300, 1e300)), 1);
}

TEST(Math, ArcTangentOfTwoIsWithinTwoUlp) {
  Points points;
  double most = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double y = points.any_magnitude(1e-3, 1e3), x = points.any_magnitude(1e-3, 1e3);
    const long double reference = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    most = std::max(most, ulps(math::atan2(y, x), reference));
  }
  EXPECT_LT(most, 2);
}

TEST(Math, ArcSineAndArcCosineAreWithinOneUlpAndAFifth) {
  EXPECT_LT(worst(math::asin, [](long double x) { return std::asin(x); }, range(-1, 1)), 1.2);
  EXPECT_LT(worst(math::asin, [](long double x) { return std::asin(x); }, magnitudes(1e-300, 1)), 1.2);
  EXPECT_LT(worst(math::acos, [](long double x) { return std::acos(x); }, range(-1, 1)), 1);
  EXPECT_LT(worst(math::acos, [](long double x) { return std::acos(x); }, range(0.999, 1)), 1);
}

TEST(Math, ExponentialAndLogarithmAreWithinOneUlp) {
  const auto exponential = [](long double x) { return std::exp(x); };
  const auto logarithm = [](long double x) { return std::log(x); };
  EXPECT_LT(worst(math::exp, exponential, range(-1, 1)), 1);
  EXPECT_LT(worst(math::exp, exponential, range(-708, 709.7)), 1);
  EXPECT_LT(worst(math::exp, exponential, range(-745, -708)), 1.01) << "subnormal: rounded twice";
  EXPECT_LT(worst(math::log, logarithm, range(0.5, 2)), 1);
  EXPECT_LT(worst(math::log, logarithm, [](Points& p) { return std::fabs(p.any_magnitude(1e-320, 1e308)); }), 1);
}

TEST(Math, SquareRootIsTheNearestDoubleBothWays) {
  Points points;
  for (int i = 0; i < kPoints; ++i) {
    const double x = std::fabs(points.any_magnitude(1e-320, 1e308));
    ASSERT_EQ(math::sqrt(x), std::sqrt(x));
    ASSERT_EQ(math::sqrt_bit_by_bit(x), std::sqrt(x)) << x;
  }
  for (const double x : {0.0, kTiny, 1.0, 4.0, std::nextafter(4.0, 0.0), std::numeric_limits<double>::max(), kInf})
    EXPECT_EQ(math::sqrt_bit_by_bit(x), std::sqrt(x)) << x;
  EXPECT_TRUE(std::isnan(math::sqrt_bit_by_bit(-1)));
  EXPECT_TRUE(std::isnan(math::sqrt_bit_by_bit(kNan)));
}

TEST(Math, HypotIsWithinTwoUlpAtEveryScale) {
  Points points;
  double most = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double x = points.any_magnitude(1e-307, 1e307);
    const double y = x * points.any_magnitude(1e-20, 1);
    const long double reference = std::hypot(static_cast<long double>(x), static_cast<long double>(y));
    most = std::max(most, ulps(math::hypot(x, y), reference));
  }
  EXPECT_LT(most, 2);
}

TEST(Math, RemainderAndFloorAreExact) {
  Points points;
  for (int i = 0; i < 20'000; ++i) {
    const double x = points.any_magnitude(1e-320, 1e300), y = points.any_magnitude(1e-320, 1e300);
    ASSERT_EQ(math::fmod(x, y), std::fmod(x, y)) << x << " " << y;
    const double near = points.between(-1e3, 1e3);
    ASSERT_EQ(math::fmod(near, 0.1), std::fmod(near, 0.1)) << near;
    ASSERT_EQ(math::floor(near), std::floor(near)) << near;
    ASSERT_EQ(math::floor(x), std::floor(x)) << x;
    ASSERT_EQ(math::ceil(near), std::ceil(near)) << near;
    for (const double half : {std::floor(near) + 0.5, std::nextafter(std::floor(near) + 0.5, near), near, x})
      ASSERT_EQ(math::round(half), std::round(half)) << half;
  }
}

using Unary = double (*)(double);
struct SpecialCase {
  const char* name;
  Unary ours;
  Unary reference;
};

TEST(Math, SpecialValuesAreThoseOfIeee754) {
  const std::array cases{
      SpecialCase{"sin", math::sin, std::sin},    SpecialCase{"cos", math::cos, std::cos},
      SpecialCase{"tan", math::tan, std::tan},    SpecialCase{"atan", math::atan, std::atan},
      SpecialCase{"asin", math::asin, std::asin}, SpecialCase{"acos", math::acos, std::acos},
      SpecialCase{"exp", math::exp, std::exp},    SpecialCase{"log", math::log, std::log},
      SpecialCase{"sqrt", math::sqrt, std::sqrt}, SpecialCase{"floor", math::floor, std::floor},
      SpecialCase{"fabs", math::fabs, std::fabs}, SpecialCase{"ceil", math::ceil, std::ceil},
      SpecialCase{"round", math::round, std::round}};
  for (const SpecialCase& c : cases) {
    for (const double x : {0.0, -0.0, 1.0, -1.0, kInf, -kInf, kNan, kTiny, -kTiny, 1e-310}) {
      const double got = c.ours(x), expected = c.reference(x);
      if (std::isnan(expected)) {
        EXPECT_TRUE(std::isnan(got)) << c.name << " of " << x;
      } else {
        EXPECT_NEAR(std::isinf(expected) ? 0 : got, std::isinf(expected) ? 0 : expected, 1e-15) << c.name << x;
        EXPECT_EQ(std::isinf(got), std::isinf(expected)) << c.name << " of " << x;
        EXPECT_EQ(std::signbit(got), std::signbit(expected)) << c.name << " of " << x;
      }
    }
  }
  EXPECT_EQ(math::exp(710), kInf);
  EXPECT_EQ(math::exp(-746), 0);
}

TEST(Math, ArcTangentOfTwoKnowsEveryQuadrantAndZero) {
  const std::array values{0.0, -0.0, 1.0, -1.0, kInf, -kInf, kNan, 1e300, 1e-300};
  for (const double y : values)
    for (const double x : values) {
      const double got = math::atan2(y, x), expected = std::atan2(y, x);
      if (std::isnan(expected)) {
        EXPECT_TRUE(std::isnan(got));
      } else {
        EXPECT_NEAR(got, expected, 1e-15) << y << " " << x;
        EXPECT_EQ(std::signbit(got), std::signbit(expected)) << y << " " << x;
      }
    }
}

TEST(Math, RemainderAndHypotAtTheEdges) {
  EXPECT_TRUE(std::isnan(math::fmod(1, 0)));
  EXPECT_TRUE(std::isnan(math::fmod(kInf, 1)));
  EXPECT_TRUE(std::isnan(math::fmod(1, kNan)));
  EXPECT_EQ(math::fmod(5, kInf), 5);
  EXPECT_TRUE(std::signbit(math::fmod(-6, 3)));
  EXPECT_EQ(math::hypot(kInf, kNan), kInf);
  EXPECT_TRUE(std::isnan(math::hypot(1, kNan)));
  EXPECT_EQ(math::hypot(3e300, 4e300), 5e300);
  EXPECT_EQ(math::hypot(0, -2), 2);
  EXPECT_EQ(math::hypot(kTiny, 0), kTiny);
}

// If one bit of a result changes, the behaviour changes on every machine: recorded runs no longer repeat.
TEST(Math, EveryBitIsAsRecorded) {
  Points points;
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](double x) { hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001b3u; };
  for (int i = 0; i < 20'000; ++i) {
    const double x = points.between(-100, 100), y = points.between(-100, 100), unit = points.between(-1, 1);
    add(math::sin(x));
    add(math::cos(y));
    add(math::tan(x));
    add(math::sin(x * 1e9));
    add(math::atan2(y, x));
    add(math::asin(unit));
    add(math::acos(unit));
    add(math::exp(x));
    add(math::log(math::fabs(y)));
    add(math::sqrt(math::fabs(x)));
    add(math::hypot(x, y));
    add(math::fmod(x, y));
    add(math::floor(x));
  }
  EXPECT_EQ(hash, 0x2ab90e73f22d5fccu);
}

}  // namespace
}  // namespace chimera
