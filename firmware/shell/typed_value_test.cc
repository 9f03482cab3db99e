// SPDX-License-Identifier: Apache-2.0
#include "firmware/shell/typed_value.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "chimera/task/abi.h"

namespace chimera::firmware::typed_value_test {
namespace {

/// Bytes of the value, or the reason of the refusal.
struct Typed {
  std::string why;
  std::vector<std::byte> bytes;

  template <class T>
  T at(std::size_t i) const {
    T value{};
    std::memcpy(&value, bytes.data() + i * sizeof value, sizeof value);
    return value;
  }
};

Typed type(const ValueShape& shape, std::vector<std::string_view> words, std::string_view text = "") {
  std::array<std::byte, kMostValueBytes> memory{};
  TypedValue value(shape, words, text, memory);
  TextLine why;
  Typed typed;
  bool is_good = value.begin(why);
  while (is_good && !value.is_complete()) is_good = value.read_next(why);
  if (is_good) typed.bytes.assign(value.bytes().begin(), value.bytes().end());
  typed.why = std::string(why.view());
  EXPECT_EQ(is_good, typed.why.empty());
  return typed;
}

ValueShape shape(std::uint32_t type, std::uint32_t bytes, std::uint32_t count = 1, std::string_view unit = "1") {
  return {"x", unit, type, bytes, count};
}

TEST(TypedValue, ReadsEveryTypeToItsLimits) {
  EXPECT_EQ(type(shape(CHIMERA_BOOL, 1), {"true"}).at<std::uint8_t>(0), 1);
  EXPECT_EQ(type(shape(CHIMERA_BOOL, 1), {"0"}).at<std::uint8_t>(0), 0);
  EXPECT_EQ(type(shape(CHIMERA_INT32, 4), {"-2147483648"}).at<std::int32_t>(0), INT32_MIN);
  EXPECT_EQ(type(shape(CHIMERA_INT64, 8), {"9223372036854775807"}).at<std::int64_t>(0), INT64_MAX);
  EXPECT_EQ(type(shape(CHIMERA_FLOAT32, 4), {"0.1"}).at<float>(0), 0.1f);
  EXPECT_EQ(type(shape(CHIMERA_FLOAT64, 8), {".5e1"}).at<double>(0), 5.0);
  const Typed list = type(shape(CHIMERA_FLOAT64, 8, 3, "rad"), {"1", "-2", "3", "rad"});
  EXPECT_EQ(list.at<double>(1), -2.0);
  EXPECT_EQ(list.at<double>(2), 3.0);
}

TEST(TypedValue, RefusesNumbersBeyondTheirType) {
  EXPECT_EQ(type(shape(CHIMERA_BOOL, 1), {"2"}).why, "'2' is no bool: true, false, 1 or 0");
  EXPECT_EQ(type(shape(CHIMERA_INT32, 4), {"2147483648"}).why, "'2147483648' is no int32");
  EXPECT_EQ(type(shape(CHIMERA_INT64, 8), {"9223372036854775808"}).why,
            "'9223372036854775808' is no int64");
  EXPECT_EQ(type(shape(CHIMERA_INT64, 8), {"99999999999999999999999"}).why,
            "'99999999999999999999999' is no int64");
  EXPECT_EQ(type(shape(CHIMERA_FLOAT32, 4), {"1e39"}).why, "'1e39' is no float32");
  EXPECT_EQ(type(shape(CHIMERA_FLOAT64, 8), {"1x"}).why, "'1x' is no float64");
}

TEST(TypedValue, UnitMustBeThatOfTheVariable) {
  EXPECT_EQ(type(shape(CHIMERA_FLOAT64, 8, 1, "m/s"), {"1", "km/h"}).why, "x is in m/s, not in 'km/h'");
  EXPECT_EQ(type(shape(CHIMERA_FLOAT64, 8, 1, "m/s"), {"nan"}).why, "x is in m/s, not in 'nan'");
  EXPECT_EQ(type(shape(CHIMERA_FLOAT64, 8), {"1", "m"}).why, "x has no unit, and 'm' is no number");
  EXPECT_EQ(type(shape(CHIMERA_FLOAT64, 8, 1, "m/s"), {"m/s"}).why, "x has 1 element, not 0");
}

TEST(TypedValue, TextsKeepTheirBlanksAndEndWithZero) {
  const Typed text = type(shape(CHIMERA_STRING, 8), {"two", "bits"}, "two bit");
  EXPECT_STREQ(reinterpret_cast<const char*>(text.bytes.data()), "two bit");
  EXPECT_EQ(type(shape(CHIMERA_STRING, 8), {"two", "bits"}, "two bits").why, "x takes a text of 7 bytes, not 8");
}

TEST(TypedValue, RefusesShapesThatFitNoLine) {
  EXPECT_EQ(type(shape(CHIMERA_STRUCT, 16), {"1"}).why, "x is a struct");
  EXPECT_EQ(type(shape(CHIMERA_STRING, 8, 2), {"a"}, "a").why, "x does not fit in a line");
  EXPECT_EQ(type(shape(CHIMERA_FLOAT64, 8, 2), {"1"}).why, "x has 2 elements, not 1");
}

}  // namespace
}  // namespace chimera::firmware::typed_value_test
