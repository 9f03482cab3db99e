// SPDX-License-Identifier: Apache-2.0
#include "chimera/text/decimal.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(Decimal, KeepsSignDigitsAndExponent) {
  const auto number = read_decimal("-12.50e3 kg");
  ASSERT_TRUE(number);
  EXPECT_TRUE(number->value.negative);
  EXPECT_EQ(number->value.digits, 125u);
  EXPECT_EQ(number->value.exponent, 2);
  EXPECT_EQ(number->nearest, -12500);
  EXPECT_EQ(number->length, 8u);
}

TEST(Decimal, ReadsDecimalNotationOnly) {
  EXPECT_EQ(read_decimal("010")->nearest, 10);
  EXPECT_EQ(read_decimal("0x10")->length, 1u);
  EXPECT_EQ(read_decimal("+.5")->nearest, 0.5);
  EXPECT_EQ(read_decimal("5.")->nearest, 5);
  EXPECT_EQ(read_decimal("1e")->length, 1u);
  EXPECT_EQ(read_decimal("1eV")->length, 1u);
}

TEST(Decimal, RefusesTextThatIsNoFiniteNumber) {
  for (const char* text : {"", "-", ".", "e5", "nan", "inf", "--1", " 1", "1e999", "+-1"}) {
    EXPECT_FALSE(read_decimal(text)) << text;
  }
  EXPECT_FALSE(read_decimal("1e" + std::string(1000, '9')));
  EXPECT_EQ(read_decimal("1e-999")->nearest, 0);
}

TEST(Decimal, ScalesExactlyOrNotAtAll) {
  EXPECT_EQ(read_decimal("0.1")->value.whole(1'000'000), 100'000);
  EXPECT_EQ(read_decimal("-0.1")->value.whole(10), -1);
  EXPECT_EQ(read_decimal("0.15")->value.whole(10), std::nullopt);
  EXPECT_EQ(read_decimal("9223372036854775807")->value.whole(1), INT64_MAX);
  EXPECT_EQ(read_decimal("9223372036854775808")->value.whole(1), std::nullopt);
  EXPECT_EQ(read_decimal("1e300")->value.whole(1), std::nullopt);
  EXPECT_EQ(read_decimal("0e300")->value.whole(1), 0);
}

TEST(Decimal, SaysWhenItCouldNotHoldEveryDigit) {
  EXPECT_TRUE(read_decimal("1." + std::string(40, '0'))->is_exact);
  EXPECT_FALSE(read_decimal("1." + std::string(40, '0') + "1")->is_exact);
  EXPECT_EQ(read_decimal("1" + std::string(30, '0'))->value.exponent, 30);
}

}  // namespace
}  // namespace chimera
