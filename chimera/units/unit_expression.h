// SPDX-License-Identifier: Apache-2.0
// The unit of a generic port: a unit and powers of the unit variables U X Y Z ("U", "U/s", "U.X", "U2").
// Verification solves the variables for each task: solve() from a concrete neighbour, substitute() for the rest.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/units/unit.h"

namespace chimera {

/// The letters that stand for any unit. None of them is a unit (V, W, N, J and others are).
inline constexpr std::string_view kUnitVariables = "UXYZ";

/// A word of a unit text with its exponent: s and -2 in "m/s2".
struct UnitWord {
  std::string name;
  int exponent = 1;
};

/// `rest` times the product of variable powers, in the order of kUnitVariables.
struct UnitExpression {
  std::array<std::int16_t, kUnitVariables.size()> variables{};
  Unit rest;
  std::vector<UnitWord> words{};  ///< `rest` as people write it, so that "X/U" of V and A is V/A; empty: base units

  /// True if it has no variable: `rest` is the unit.
  bool is_concrete() const noexcept;
  /// The number of different variables in it.
  int unknowns() const noexcept;
};

UnitExpression operator*(const UnitExpression& a, const UnitExpression& b);
UnitExpression operator/(const UnitExpression& a, const UnitExpression& b);
UnitExpression power(const UnitExpression& expression, int exponent);

/// `expression` with every `variable` (a letter of kUnitVariables) replaced. "U/s" with m for U is m/s; with degC it is
/// K/s. An offset remains only if the expression is the variable alone. Context: setup.
UnitExpression substitute(const UnitExpression& expression, char variable, const UnitExpression& unit);

/// A variable and its solved unit.
struct Solved {
  char variable = 'U';
  UnitExpression unit;
};

/// The value of the only unknown of `expression` for which it becomes `unit`: "U/s" and m/s give U = m. nullopt if
/// there is not exactly one unknown, or if no unit fits ("U2" and m/s). Context: setup.
std::optional<Solved> solve(const UnitExpression& expression, const UnitExpression& unit);

/// "U.m/s" in the words that were written, else in base units.
std::string text(const UnitExpression& expression);

}  // namespace chimera
