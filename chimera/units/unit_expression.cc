// SPDX-License-Identifier: Apache-2.0
// Solves and substitutes the unit variables of generic ports.
#include "chimera/units/unit_expression.h"

#include <algorithm>
#include <cstdlib>

#include "chimera/base/hosted/wording.h"

namespace chimera {
namespace {

/// `words` times `more` to the power of `exponent`; a word that cancels out is gone.
std::vector<UnitWord> product_of(std::vector<UnitWord> words, const std::vector<UnitWord>& more, int exponent) {
  for (const UnitWord& word : more) {
    const auto known = std::ranges::find(words, word.name, &UnitWord::name);
    if (known != words.end()) known->exponent += word.exponent * exponent;
    else words.push_back({word.name, word.exponent * exponent});
  }
  std::erase_if(words, [](const UnitWord& word) { return word.exponent == 0; });
  return words;
}

std::string text_of(const std::vector<UnitWord>& words) {
  if (words.size() == 1 && words[0].exponent == 1) return words[0].name;
  std::string above, below;
  for (const UnitWord& word : words) {
    const std::string name = word.name.find_first_of(" ./") == std::string::npos ? word.name : "(" + word.name + ")";
    const int size = std::abs(word.exponent);
    append_joined(word.exponent > 0 ? above : below, ".", size == 1 ? name : name + std::to_string(size));
  }
  if (above.empty()) above = "1";
  if (below.empty()) return above;
  return above + "/" + (below.find('.') == std::string::npos ? below : "(" + below + ")");
}

}  // namespace

bool UnitExpression::is_concrete() const noexcept { return unknowns() == 0; }

int UnitExpression::unknowns() const noexcept {
  return static_cast<int>(std::count_if(variables.begin(), variables.end(), [](int e) { return e != 0; }));
}

UnitExpression operator*(const UnitExpression& a, const UnitExpression& b) {
  UnitExpression product{.variables = {}, .rest = a.rest * b.rest, .words = product_of(a.words, b.words, 1)};
  for (std::size_t i = 0; i < product.variables.size(); ++i) {
    product.variables[i] = bounded_exponent(a.variables[i] + b.variables[i]);
  }
  return product;
}

UnitExpression operator/(const UnitExpression& a, const UnitExpression& b) { return a * power(b, -1); }

UnitExpression power(const UnitExpression& expression, int exponent) {
  UnitExpression raised{.variables = {},
                        .rest = power(expression.rest, exponent),
                        .words = product_of({}, expression.words, exponent)};
  for (std::size_t i = 0; i < raised.variables.size(); ++i) {
    raised.variables[i] = bounded_exponent(expression.variables[i] * exponent);
  }
  return raised;
}

UnitExpression substitute(const UnitExpression& expression, char variable, const UnitExpression& unit) {
  const std::size_t index = kUnitVariables.find(variable);
  if (index == std::string_view::npos || expression.variables[index] == 0) return expression;
  UnitExpression others = expression;
  others.variables[index] = 0;
  // A variable alone keeps the offset, so that a generic filter passes degC on.
  if (expression.variables[index] == 1 && others.is_concrete() && same(expression.rest, Unit{})) return unit;
  return power(unit, expression.variables[index]) * others;
}

std::optional<Solved> solve(const UnitExpression& expression, const UnitExpression& unit) {
  if (expression.unknowns() != 1) return std::nullopt;
  const auto found =
      std::find_if(expression.variables.begin(), expression.variables.end(), [](int e) { return e != 0; });
  const int exponent = *found;
  const char variable = kUnitVariables[static_cast<std::size_t>(found - expression.variables.begin())];
  if (exponent == 1 && same(expression.rest, Unit{})) return Solved{variable, unit};
  const auto value = root(unit.rest / expression.rest, exponent);
  if (!value) return std::nullopt;
  Solved solved{variable, {.variables = {}, .rest = *value, .words = product_of(unit.words, expression.words, -1)}};
  const auto has_root = [exponent](const UnitWord& word) { return word.exponent % exponent == 0; };
  if (!std::ranges::all_of(solved.unit.words, has_root)) solved.unit.words = {UnitWord{text(*value)}};
  else for (UnitWord& word : solved.unit.words) word.exponent /= exponent;
  return solved;
}

std::string text(const UnitExpression& expression) {
  std::string rest = expression.words.empty() ? text(expression.rest) : text_of(expression.words);
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
