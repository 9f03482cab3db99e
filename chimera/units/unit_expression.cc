// SPDX-License-Identifier: Apache-2.0
// Solves and substitutes the unit variables of generic ports.
#include "chimera/units/unit_expression.h"

#include <algorithm>

namespace chimera {
bool UnitExpression::is_concrete() const noexcept { return unknowns() == 0; }

int UnitExpression::unknowns() const noexcept {
  return static_cast<int>(std::count_if(variables.begin(), variables.end(), [](int e) { return e != 0; }));
}

UnitExpression operator*(const UnitExpression& a, const UnitExpression& b) noexcept {
  UnitExpression product{.variables = {}, .rest = a.rest * b.rest};
  for (std::size_t i = 0; i < product.variables.size(); ++i) {
    product.variables[i] = bounded_exponent(a.variables[i] + b.variables[i]);
  }
  return product;
}

UnitExpression operator/(const UnitExpression& a, const UnitExpression& b) noexcept { return a * power(b, -1); }

UnitExpression power(const UnitExpression& expression, int exponent) noexcept {
  UnitExpression raised{.variables = {}, .rest = power(expression.rest, exponent)};
  for (std::size_t i = 0; i < raised.variables.size(); ++i) {
    raised.variables[i] = bounded_exponent(expression.variables[i] * exponent);
  }
  return raised;
}

UnitExpression substitute(const UnitExpression& expression, char variable, const Unit& unit) noexcept {
  const std::size_t index = kUnitVariables.find(variable);
  if (index == std::string_view::npos || expression.variables[index] == 0) return expression;
  UnitExpression result = expression;
  result.variables[index] = 0;
  // A variable alone keeps the offset, so that a generic filter passes degC on.
  const bool alone = expression.variables[index] == 1 && result.is_concrete() && same(expression.rest, Unit{});
  result.rest = alone ? unit : expression.rest * power(unit, expression.variables[index]);
  return result;
}

std::optional<Solved> solve(const UnitExpression& expression, const Unit& unit) noexcept {
  if (expression.unknowns() != 1) return std::nullopt;
  const auto found =
      std::find_if(expression.variables.begin(), expression.variables.end(), [](int e) { return e != 0; });
  const char variable = kUnitVariables[static_cast<std::size_t>(found - expression.variables.begin())];
  if (*found == 1 && same(expression.rest, Unit{})) return Solved{variable, unit};
  const auto value = root(unit / expression.rest, *found);
  if (!value) return std::nullopt;
  return Solved{variable, *value};
}

std::string text(const UnitExpression& expression) {
  std::string rest = text(expression.rest);
  std::string all;
  for (std::size_t i = 0; i < expression.variables.size(); ++i) {
    const int exponent = expression.variables[i];
    if (exponent == 0) continue;
    if (!all.empty()) all += '.';
    all += kUnitVariables[i];
    if (exponent != 1) all += std::to_string(exponent);
  }
  if (all.empty()) return rest;
  if (rest == "1") return all;
  return rest.starts_with("1/") ? all + rest.substr(1) : all + "." + rest;
}

}  // namespace chimera
