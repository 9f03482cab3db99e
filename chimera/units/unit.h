// SPDX-License-Identifier: Apache-2.0
// A unit of measurement as plain data: what it is made of and how large it is. docs/formats/units.md tells
// which units there are and why rad/s is not Hz.
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

/// to = from * factor + offset. Exactly 1 and 0 for units that are the same.
struct Conversion {
  double factor = 1;
  double offset = 0;

  double operator()(double value) const noexcept;
};

/// Both measure the same thing in the same size (N.s/kg and m/s): ports may be connected. Sizes count as equal
/// within 1e-12, which is the rounding of the file's own factors. Context: setup.
bool same(const Unit& a, const Unit& b) noexcept;

/// How to make values in `to` from values in `from`; nullopt when they measure different things. Context: setup.
std::optional<Conversion> conversion(const Unit& from, const Unit& to) noexcept;

/// Within +-1000. Context: setup.
std::int16_t bounded_exponent(int exponent) noexcept;
/// Products and powers; exponents are bounded. An offset is lost: degC/s is K/s, because only a lone degC
/// is a point on a scale.
Unit operator*(const Unit& a, const Unit& b) noexcept;
Unit operator/(const Unit& a, const Unit& b) noexcept;
Unit power(const Unit& unit, int exponent) noexcept;
/// The unit whose power is `unit`; nullopt when its exponents cannot be divided. Requires: exponent != 0.
std::optional<Unit> root(const Unit& unit, int exponent) noexcept;

/// The unit in base units, for messages and where nobody wrote a text: "kg.m2/s2", "1000 m", "1".
std::string text(const Unit& unit);

}  // namespace chimera
