// SPDX-License-Identifier: Apache-2.0
// Multiplies, compares and converts units.
#include "chimera/units/unit.h"

#include <algorithm>
#include <cmath>

#include "chimera/base/hosted/wording.h"

namespace chimera {
namespace {

constexpr const char* kBaseNames[kBaseUnits] = {"m", "kg", "s", "A", "K", "mol", "cd", "rad"};
constexpr double kRounding = 1e-12;
bool nearly(double a, double b) { return a == b || std::abs(a - b) <= kRounding * std::max(std::abs(a), std::abs(b)); }

std::string number(double value) { return formatted("%.12g", value); }

void append(std::string& text, const char* name, int exponent) {
  if (!text.empty()) text += '.';
  text += name;
  if (exponent != 1) text += std::to_string(exponent);
}

}  // namespace

std::int16_t bounded_exponent(int exponent) noexcept {
  constexpr int kLargest = 1000;
  return static_cast<std::int16_t>(std::clamp(exponent, -kLargest, kLargest));
}

std::string base_unit_name(std::size_t index) { return kBaseNames[index]; }

bool Unit::is_dimensionless() const noexcept {
  return std::all_of(exponents.begin(), exponents.end(), [](int e) { return e == 0; });
}

double Conversion::operator()(double value) const noexcept {
  // A division by a whole number rounds once, where a product with its rounded inverse rounds twice: 40 us is 4e-05 s.
  const double inverse = std::round(1 / factor);
  const bool divides = std::abs(factor) < 1 && factor != 0 && nearly(inverse * factor, 1);
  return (divides ? value / inverse : value * factor) + offset;
}

bool same(const Unit& a, const Unit& b) noexcept {
  return a.exponents == b.exponents && nearly(a.factor, b.factor) && nearly(a.offset, b.offset);
}

std::optional<Conversion> conversion(const Unit& from, const Unit& to) noexcept {
  if (from.exponents != to.exponents) return std::nullopt;
  if (same(from, to)) return Conversion{};
  const double factor = from.factor / to.factor;
  return Conversion{nearly(factor, 1) ? 1 : factor, from.offset * factor - to.offset};
}

Unit operator*(const Unit& a, const Unit& b) noexcept {
  Unit product{.exponents = {}, .factor = a.factor * b.factor, .offset = 0};
  for (std::size_t i = 0; i < kBaseUnits; ++i) product.exponents[i] = bounded_exponent(a.exponents[i] + b.exponents[i]);
  return product;
}

Unit operator/(const Unit& a, const Unit& b) noexcept { return a * power(b, -1); }

Unit power(const Unit& unit, int exponent) noexcept {
  if (exponent == 1) return unit;
  Unit raised{.exponents = {}, .factor = std::pow(unit.factor, exponent), .offset = 0};
  for (std::size_t i = 0; i < kBaseUnits; ++i) raised.exponents[i] = bounded_exponent(unit.exponents[i] * exponent);
  return raised;
}

std::optional<Unit> root(const Unit& unit, int exponent) noexcept {
  if (exponent == 1) return unit;
  Unit found{.exponents = {}, .factor = std::pow(unit.factor, 1.0 / exponent), .offset = 0};
  for (std::size_t i = 0; i < kBaseUnits; ++i) {
    if (unit.exponents[i] % exponent != 0) return std::nullopt;
    found.exponents[i] = static_cast<std::int16_t>(unit.exponents[i] / exponent);
  }
  return found;
}

std::string text(const Unit& unit) {
  std::string above, below;
  int factors_below = 0;
  for (std::size_t i = 0; i < kBaseUnits; ++i) {
    if (unit.exponents[i] > 0) append(above, kBaseNames[i], unit.exponents[i]);
    if (unit.exponents[i] < 0) append(below, kBaseNames[i], -unit.exponents[i]), ++factors_below;
  }
  if (above.empty()) above = "1";
  if (factors_below > 1) below = "(" + below + ")";
  std::string whole = below.empty() ? above : above + "/" + below;
  if (!nearly(unit.factor, 1)) whole = whole == "1" ? number(unit.factor) : number(unit.factor) + " " + whole;
  if (unit.offset != 0) whole += " from " + number(-unit.offset);
  return whole;
}

}  // namespace chimera
