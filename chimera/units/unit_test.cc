// SPDX-License-Identifier: Apache-2.0
#include "chimera/units/unit.h"

#include <gtest/gtest.h>

#include "chimera/units/testing/unit_samples.h"

namespace chimera {
namespace {

enum class Verdict { kSame, kConvertible, kRefused };

/// A pair of units that people, or other systems of units, confuse.
struct Pair {
  const char* a;
  const char* b;
  Verdict verdict;
  double factor = 1;  ///< b = a * factor + offset
  double offset = 0;
};

constexpr Pair kPairs[] = {
    // Rotation is not frequency, angle is not a number.
    {"rad/s", "Hz", Verdict::kRefused},
    {"rad/s", "1/s", Verdict::kRefused},
    {"rad", "1", Verdict::kRefused},
    {"deg", "1", Verdict::kRefused},
    {"deg", "rad", Verdict::kConvertible, 0.017453292519943295},
    {"rev", "deg", Verdict::kConvertible, 360},
    {"rpm", "rad/s", Verdict::kConvertible, 0.10471975511965977},
    {"rpm", "Hz", Verdict::kRefused},
    {"deg/s", "rad/s", Verdict::kConvertible, 0.017453292519943295},
    {"sr", "rad", Verdict::kRefused},
    {"sr", "rad2", Verdict::kSame},
    // Torque, energy, stiffness.
    {"N.m", "J", Verdict::kRefused},
    {"N.m.rad", "J", Verdict::kSame},
    {"N.m/rad", "N.m", Verdict::kRefused},
    {"N.m/rad", "N.m/deg", Verdict::kConvertible, 0.017453292519943295},
    {"N.m/rad", "N/m", Verdict::kRefused},
    {"N.m.s/rad", "N.s/m", Verdict::kRefused},
    {"N.m.rad/s", "W", Verdict::kSame},
    {"N.m.s", "J.s", Verdict::kRefused},
    {"W.s", "J", Verdict::kSame},
    {"Wh", "J", Verdict::kConvertible, 3600},
    {"W.h", "Wh", Verdict::kSame},
    {"N.m", "mN", Verdict::kRefused},
    {"m.N", "N.m", Verdict::kSame},
    {"mN.m", "N.m", Verdict::kConvertible, 0.001},
    {"N.m/A", "V.s/rad", Verdict::kSame},
    {"V.A", "W", Verdict::kSame},
    {"A.h", "A/h", Verdict::kRefused},
    // Mass, force, acceleration.
    {"kg", "N", Verdict::kRefused},
    {"g", "kg", Verdict::kConvertible, 0.001},
    {"g", "gn", Verdict::kRefused},
    {"gn", "m/s2", Verdict::kConvertible, 9.80665},
    {"t", "kg", Verdict::kConvertible, 1000},
    {"m/s", "m", Verdict::kRefused},
    {"m/s", "m/s2", Verdict::kRefused},
    {"km/h", "m/s", Verdict::kConvertible, 1 / 3.6},
    {"N/kg", "m/s2", Verdict::kSame},
    {"m/s/s", "m/s2", Verdict::kSame},
    {"kg.m2/s2", "N.m", Verdict::kSame},
    // Prefixes one letter apart.
    {"mHz", "MHz", Verdict::kConvertible, 1e-9},
    {"ms", "us", Verdict::kConvertible, 1000},
    {"ms", "m.s", Verdict::kRefused},
    {"m", "min", Verdict::kRefused},
    {"min", "s", Verdict::kConvertible, 60},
    {"S", "s", Verdict::kRefused},
    {"S", "1/ohm", Verdict::kSame},
    {"Pa", "bar", Verdict::kConvertible, 1e-5},
    {"N/m2", "Pa", Verdict::kSame},
    {"L", "m3", Verdict::kConvertible, 1e-3},
    // Temperatures.
    {"degC", "K", Verdict::kConvertible, 1, 273.15},
    {"K", "degC", Verdict::kConvertible, 1, -273.15},
    {"degF", "degC", Verdict::kConvertible, 5.0 / 9, -160.0 / 9},
    {"degC/s", "K/s", Verdict::kSame},
    {"degC", "deg", Verdict::kRefused},
    {"degC", "C", Verdict::kRefused},
    // Parts of one.
    {"%", "1", Verdict::kConvertible, 0.01},
    {"ppm", "%", Verdict::kConvertible, 1e-4},
    {"%/s", "Hz", Verdict::kConvertible, 0.01},
    // Spellings.
    {"rad/s", "rad.s-1", Verdict::kSame},
    {"m/s2", "m.s^-2", Verdict::kSame},
    {"N m", "N.m", Verdict::kSame},
    {"newton.meter", "N.m", Verdict::kSame},
    {"\xc2\xb5s", "us", Verdict::kSame},
    {"\xc2\xb0/s", "deg/s", Verdict::kSame},
    {"kg/(m.s2)", "Pa", Verdict::kSame},
};

TEST(Unit, EasilyConfusedPairsAreJudgedOneByOne) {
  for (const Pair& pair : kPairs) {
    SCOPED_TRACE(std::string(pair.a) + " against " + pair.b);
    const auto found = conversion(unit(pair.a), unit(pair.b));
    EXPECT_EQ(same(unit(pair.a), unit(pair.b)), pair.verdict == Verdict::kSame);
    ASSERT_EQ(found.has_value(), pair.verdict != Verdict::kRefused);
    if (!found) continue;
    EXPECT_NEAR(found->factor, pair.factor, 1e-12 * pair.factor);
    EXPECT_NEAR(found->offset, pair.offset, 1e-9);
  }
}

TEST(Unit, ConversionRoundsOnce) {
  EXPECT_EQ((*conversion(unit("us"), unit("s")))(40), 4e-05);
  EXPECT_EQ((*conversion(unit("g"), unit("kg")))(1500), 1.5);
  EXPECT_EQ((*conversion(unit("kHz"), unit("Hz")))(1), 1000);
  EXPECT_EQ((*conversion(unit("degC"), unit("K")))(20), 293.15);
}

TEST(Unit, PrintsInBaseUnits) {
  EXPECT_EQ(text(unit("1")), "1");
  EXPECT_EQ(text(unit("N.m/rad")), "m2.kg/(s2.rad)");
  EXPECT_EQ(text(unit("km")), "1000 m");
  EXPECT_EQ(text(unit("%")), "0.01");
  EXPECT_EQ(text(unit("Hz")), "1/s");
  EXPECT_EQ(text(unit("degC")), "K from -273.15");
}

TEST(Unit, RootsExistOnlyWhereExponentsDivide) {
  EXPECT_TRUE(same(*root(unit("m2/s2"), 2), unit("m/s")));
  EXPECT_TRUE(same(*root(unit("m/s"), -1), unit("s/m")));
  EXPECT_FALSE(root(unit("m/s2"), 2));
}

TEST(Unit, ExponentsStayBounded) {
  Unit hostile = unit("m30");
  for (int i = 0; i < 50; ++i) hostile = power(hostile, 30);
  EXPECT_EQ(hostile.exponents[0], 1000);
}

}  // namespace
}  // namespace chimera
