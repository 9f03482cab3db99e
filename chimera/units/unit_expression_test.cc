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
  const auto derivative = solve(expression("U/s"), expression("m/s"));
  ASSERT_TRUE(derivative);
  EXPECT_EQ(derivative->variable, 'U');
  EXPECT_TRUE(same(derivative->unit.rest, unit("m")));
  EXPECT_TRUE(same(solve(expression("N/X"), expression("N/kg"))->unit.rest, unit("kg")));
  EXPECT_TRUE(same(solve(expression("U2"), expression("m2/s2"))->unit.rest, unit("m/s")));
  EXPECT_TRUE(same(solve(expression("U-1"), expression("Hz"))->unit.rest, unit("s")));
}

TEST(UnitExpression, RefusesToSolveTwoUnknownsOrNoneOrAnOddRoot) {
  EXPECT_FALSE(solve(expression("U.X"), expression("m")));
  EXPECT_FALSE(solve(expression("m"), expression("m")));
  EXPECT_FALSE(solve(expression("U2"), expression("m")));
}

TEST(UnitExpression, SubstitutesAndComesBack) {
  const UnitExpression product = substitute(expression("U.X"), 'U', expression("N.m"));
  EXPECT_EQ(product.unknowns(), 1);
  EXPECT_TRUE(same(substitute(product, 'X', expression("rad/s")).rest, unit("W")));
  EXPECT_TRUE(same(substitute(expression("U/s"), 'U', expression("deg")).rest, unit("deg/s")));
  EXPECT_TRUE(same(substitute(expression("m"), 'U', expression("kg")).rest, unit("m")));
}

TEST(UnitExpression, KeepsTheZeroOfAScaleOnlyWhereTheVariableStandsAlone) {
  EXPECT_TRUE(same(solve(expression("U"), expression("degC"))->unit.rest, unit("degC")));
  EXPECT_TRUE(same(substitute(expression("U"), 'U', expression("degC")).rest, unit("degC")));
  EXPECT_TRUE(same(substitute(expression("U/s"), 'U', expression("degC")).rest, unit("K/s")));
}

TEST(UnitExpression, MultipliesAndDivides) {
  const UnitExpression quotient = expression("U.X") / expression("X.s");
  EXPECT_EQ(text(quotient), "U/s");
  EXPECT_EQ(text(expression("U") * expression("U.m")), "U2.m");
  EXPECT_EQ(text(expression("U")), "U");
  EXPECT_EQ(text(power(expression("U/s"), 2)), "U2/s2");
}

TEST(UnitExpression, KeepsTheWordsThatWereWritten) {
  const auto volt = solve(substitute(expression("X/U"), 'U', expression("A")), expression("V/A"));
  ASSERT_TRUE(volt);
  EXPECT_EQ(text(volt->unit), "V");
  EXPECT_EQ(text(substitute(substitute(expression("X.s/U"), 'X', expression("N.m")), 'U', expression("rad"))),
            "N.m.s/rad");
  EXPECT_EQ(text(substitute(substitute(expression("X/U"), 'U', expression("rad/s")), 'X', expression("V"))), "V.s/rad");
  EXPECT_EQ(text(substitute(expression("U/s"), 'U', expression("mm/s"))), "mm/s2");
  EXPECT_EQ(text(solve(expression("U2"), expression("mm2/s2"))->unit), "mm/s");
  EXPECT_EQ(text(solve(expression("U2"), expression("N.kg.m"))->unit), "m.kg/s") << "no word has a root";
}

}  // namespace
}  // namespace chimera
