// SPDX-License-Identifier: Apache-2.0
#include "chimera/units/unit_expression.h"

#include <gtest/gtest.h>

#include "chimera/units/testing/unit_samples.h"

namespace chimera {
namespace {

UnitExpression expression(std::string_view text) {
  const auto parsed = our_units().parse_expression(text);
  EXPECT_TRUE(parsed) << text;
  return parsed ? parsed.value() : UnitExpression{};
}

TEST(UnitExpression, SeparatesVariablesFromTheRest) {
  const UnitExpression e = expression("U.kg/s2");
  EXPECT_EQ(e.unknowns(), 1);
  EXPECT_FALSE(e.is_concrete());
  EXPECT_EQ(e.variables[0], 1);
  EXPECT_TRUE(same(e.rest, unit("kg/s2")));
  EXPECT_TRUE(expression("m/s").is_concrete());
  EXPECT_TRUE(expression("U/U").is_concrete());
}

TEST(UnitExpression, SolvesTheOnlyUnknown) {
  const auto derivative = solve(expression("U/s"), unit("m/s"));
  ASSERT_TRUE(derivative);
  EXPECT_EQ(derivative->variable, 'U');
  EXPECT_TRUE(same(derivative->unit, unit("m")));
  EXPECT_TRUE(same(solve(expression("N/X"), unit("N/kg"))->unit, unit("kg")));
  EXPECT_TRUE(same(solve(expression("U2"), unit("m2/s2"))->unit, unit("m/s")));
  EXPECT_TRUE(same(solve(expression("U-1"), unit("Hz"))->unit, unit("s")));
}

TEST(UnitExpression, RefusesToSolveTwoUnknownsOrNoneOrAnOddRoot) {
  EXPECT_FALSE(solve(expression("U.X"), unit("m")));
  EXPECT_FALSE(solve(expression("m"), unit("m")));
  EXPECT_FALSE(solve(expression("U2"), unit("m")));
}

TEST(UnitExpression, SubstitutesAndComesBack) {
  const UnitExpression product = substitute(expression("U.X"), 'U', unit("N.m"));
  EXPECT_EQ(product.unknowns(), 1);
  EXPECT_TRUE(same(substitute(product, 'X', unit("rad/s")).rest, unit("W")));
  EXPECT_TRUE(same(substitute(expression("U/s"), 'U', unit("deg")).rest, unit("deg/s")));
  EXPECT_TRUE(same(substitute(expression("m"), 'U', unit("kg")).rest, unit("m")));
}

TEST(UnitExpression, KeepsTheZeroOfAScaleOnlyWhereTheVariableStandsAlone) {
  EXPECT_TRUE(same(solve(expression("U"), unit("degC"))->unit, unit("degC")));
  EXPECT_TRUE(same(substitute(expression("U"), 'U', unit("degC")).rest, unit("degC")));
  EXPECT_TRUE(same(substitute(expression("U/s"), 'U', unit("degC")).rest, unit("K/s")));
}

TEST(UnitExpression, MultipliesAndDivides) {
  const UnitExpression quotient = expression("U.X") / expression("X.s");
  EXPECT_EQ(text(quotient), "U/s");
  EXPECT_EQ(text(expression("U") * expression("U.m")), "U2.m");
  EXPECT_EQ(text(expression("U")), "U");
  EXPECT_EQ(text(power(expression("U/s"), 2)), "U2/s2");
}

}  // namespace
}  // namespace chimera
