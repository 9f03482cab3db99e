// SPDX-License-Identifier: Apache-2.0
#include "chimera/text/value_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace chimera {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
  return {reinterpret_cast<const std::byte*>(&value), sizeof value};
}

ValueForm form(std::uint32_t type, std::uint32_t bytes, const char* unit = "1", std::uint32_t count = 1) {
  ValueForm made;
  made.type = type;
  made.element_bytes = bytes;
  made.unit = unit;
  made.count = count;
  made.is_scalar = count == 1;
  return made;
}

TEST(ValueText, WritesEveryPlainType) {
  EXPECT_EQ(value_text(form(CHIMERA_FLOAT64, 8, "m/s"), bytes_of(100.0 / 3.6)), "27.7778 m/s");
  EXPECT_EQ(value_text(form(CHIMERA_FLOAT32, 4, "m"), bytes_of(0.5f)), "0.5 m");
  EXPECT_EQ(value_text(form(CHIMERA_INT32, 4), bytes_of(std::int32_t{-7})), "-7");
  EXPECT_EQ(value_text(form(CHIMERA_INT32, 4), bytes_of(INT32_MAX)), "2147483647");
  EXPECT_EQ(value_text(form(CHIMERA_BOOL, 1), bytes_of(std::uint8_t{1})), "true");
  EXPECT_EQ(value_text(form(CHIMERA_STRING, 8), bytes_of("say hi\0")), "\"say hi\"");
}

TEST(ValueText, ShowsFloatsInTheUnitThatTheFileWrites) {
  ValueForm speed = form(CHIMERA_FLOAT64, 8, "m/s");
  speed.shown = "km/h", speed.factor = 3.6;
  EXPECT_EQ(value_text(speed, bytes_of(100.0 / 3.6)), "100 km/h");
  EXPECT_EQ(value_json(speed, bytes_of(0.5)), "0.5") << "programs read the unit of the variable";
  ValueForm count = form(CHIMERA_INT32, 4, "m");
  count.shown = "km", count.factor = 1e-3;
  EXPECT_EQ(value_text(count, bytes_of(std::int32_t{7})), "7 m");
}

TEST(ValueText, LosesNoDigitOfALargeWholeNumber) {
  const std::int64_t least = INT64_MIN;
  EXPECT_EQ(value_text(form(CHIMERA_INT64, 8), bytes_of(least)), "-9223372036854775808");
  EXPECT_EQ(value_json(form(CHIMERA_INT64, 8), bytes_of(least)), "-9223372036854775808");
}

TEST(ValueText, ReadsATextThatFillsItsBytes) {
  const char full[4] = {'a', '"', 'c', 'd'};
  EXPECT_EQ(value_json(form(CHIMERA_STRING, 4), bytes_of(full)), "\"a\\\"cd\"");
}

TEST(ValueText, ListsHaveBracketsAndOneUnit) {
  const double q[] = {0.1, -0.25};
  EXPECT_EQ(value_text(form(CHIMERA_FLOAT64, 8, "rad", 2), bytes_of(q)), "[0.1 -0.25] rad");
  EXPECT_EQ(value_json(form(CHIMERA_FLOAT64, 8, "rad", 2), bytes_of(q)), "[0.1, -0.25]");
}

TEST(ValueText, AListOfOneIsAList) {
  ValueForm one = form(CHIMERA_FLOAT64, 8, "m");
  one.is_scalar = false;
  EXPECT_EQ(value_text(one, bytes_of(2.0)), "[2] m");
}

TEST(ValueText, JsonHasNullForNonFiniteNumbers) {
  const double wild[] = {std::nan(""), HUGE_VAL, 1e308};
  EXPECT_EQ(value_json(form(CHIMERA_FLOAT64, 8, "1", 3), bytes_of(wild)), "[null, null, 1e+308]");
  EXPECT_EQ(value_text(form(CHIMERA_FLOAT64, 8, "1", 3), bytes_of(wild)), "[nan inf 1e+308]");
}

TEST(ValueText, AStructNamesItsFieldsEachWithItsUnit) {
  struct Pose {
    double x;
    std::int32_t n[2];
  } pose = {1.5, {3, 4}};
  ValueForm made = form(CHIMERA_STRUCT, sizeof pose);
  FieldDescriptor x, n;
  x.name = "x", x.type = CHIMERA_FLOAT64, x.unit = "m", x.offset = 0, x.size = 8, x.count = 1;
  n.name = "n", n.type = CHIMERA_INT32, n.unit = "1", n.offset = 8, n.size = 4, n.count = 2;
  made.fields = {x, n};
  EXPECT_EQ(value_text(made, bytes_of(pose)), "{x: 1.5 m, n: [3 4]}");
  EXPECT_EQ(value_json(made, bytes_of(pose)), "{\"x\": 1.5, \"n\": [3, 4]}");
  EXPECT_EQ(numbers(made, bytes_of(pose)), (std::vector<double>{1.5, 3, 4}));
}

TEST(Numbers, TextsGiveNone) { EXPECT_TRUE(numbers(form(CHIMERA_STRING, 8), bytes_of("1234567")).empty()); }

}  // namespace
}  // namespace chimera
