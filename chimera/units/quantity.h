// SPDX-License-Identifier: Apache-2.0
// A number and a unit as people write them: "1.5 kg", "100 N.m/rad", "-0.3". Durations and rates, which the framework
// itself uses, are exact.
#pragma once

#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/units/unit.h"
#include "chimera/units/unit_system.h"

namespace chimera {

/// A value in a unit; `unit_text` as written, "1" if none was written.
struct Quantity {
  double value = 0;
  Unit unit;
  std::string unit_text = "1";
};

/// Parses a decimal number (never octal, never hexadecimal; "inf" and "-inf" are numbers, "nan" is not), then an
/// optional space, then a unit. Refuses, with the text found: no number, digits that do not end, a unit that parse()
/// refuses. Context: setup.
Result<Quantity> parse_quantity(std::string_view text, const UnitSystem& units);

/// The value of `quantity` in `wanted`. Refuses a unit of another dimension, with both names. Refuses, with kRefused, a
/// finite number that overflows in that unit; a number too small for a double becomes 0. Refuses a plain number if
/// `wanted` has a dimension: "the unit is missing". Context: setup.
Result<double> value_in(const Quantity& quantity, const Unit& wanted, std::string_view wanted_text);

/// A duration from 0 to 292 years in ns, us, ms, s, min or h, in decimal arithmetic: "0.1 ms" is 100000 ns exactly.
/// Refuses a negative duration, a fraction of a nanosecond, and another unit. Context: setup.
Result<Nanoseconds> parse_duration(std::string_view text);

/// A rate in Hz, mHz, kHz, MHz or 1/s, with its exact value and its period rounded to the nearest nanosecond.
struct Rate {
  double hz = 0;
  Nanoseconds period;
};

inline constexpr Nanoseconds kShortestPeriod{1'000};             ///< 1 MHz
inline constexpr Nanoseconds kLongestPeriod{3'600'000'000'000};  ///< one hour

/// Refuses zero, a negative rate, a period outside 1 us .. 1 h, and another unit. "3 Hz" has no whole period: it
/// gets 333333333 ns, so that a billion cycles come 1 s early. Context: setup.
Result<Rate> parse_rate(std::string_view text);

}  // namespace chimera
