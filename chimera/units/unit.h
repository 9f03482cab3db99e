// SPDX-License-Identifier: Apache-2.0
// A unit of measurement as plain data: its base units and its size. docs/formats/units.md lists the units and explains
// why rad/s is not Hz.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace chimera {

/// The base dimensions, in the order of Unit::exponents: m kg s A K mol cd rad.
inline constexpr std::size_t kBaseUnits = 8;
std::string base_unit_name(std::size_t index);

/// A value x in this unit is factor * (x + offset) in the base units. Only temperatures have an offset.
struct Unit {
  std::array<std::int16_t, kBaseUnits> exponents{};
  double factor = 1;
  double offset = 0;

  bool is_dimensionless() const noexcept;
};

/// to = from * factor + offset. Exactly 1 and 0 for equal units.
struct Conversion {
  double factor = 1;
  double offset = 0;

  double operator()(double value) const noexcept;
};

/// True if both measure one quantity in one size (N.s/kg and m/s), so that ports may be connected. Sizes count as equal
/// within 1e-12, the rounding of the factors in the file. Context: setup.
bool same(const Unit& a, const Unit& b) noexcept;

/// The conversion of values from `from` to `to`; nullopt if their dimensions differ. Context: setup.
std::optional<Conversion> conversion(const Unit& from, const Unit& to) noexcept;

/// Within +-1000. Context: setup.
std::int16_t bounded_exponent(int exponent) noexcept;
/// Products and powers; exponents are bounded. An offset is lost: degC/s is K/s, because only degC alone is a point on
/// a scale.
Unit operator*(const Unit& a, const Unit& b) noexcept;
Unit operator/(const Unit& a, const Unit& b) noexcept;
Unit power(const Unit& unit, int exponent) noexcept;
/// The unit whose power is `unit`; nullopt when its exponents cannot be divided. Requires: exponent != 0.
std::optional<Unit> root(const Unit& unit, int exponent) noexcept;

/// The unit in base units, for messages and for units without a written text: "kg.m2/s2", "1000 m", "1".
std::string text(const Unit& unit);

}  // namespace chimera
