// SPDX-License-Identifier: Apache-2.0
// A condition at the end of a run, "error <= 2 mrad", on which its exit code depends.
#pragma once

#include <string>
#include <vector>

#include "chimera/units/unit.h"
#include "chimera/units/unit_system.h"
#include "chimera/verify/configuration.h"

namespace chimera::cli {

/// The present value of a state variable, read in this or in another process.
struct Seen {
  bool is_written = false;
  std::string text;             ///< "27.7778 m/s"
  std::vector<double> numbers;  ///< all of them, in the unit of the variable
};

/// The state variable of that name; refuses an unknown name with the nearest one. Context: setup.
Result<const ConfiguredVariable*> find_variable(const Configuration& configuration, const std::string& name);

/// The right side of an expectation, in the unit of its variable.
struct Bound {
  double value = 0;
  Conversion to_written{};  ///< to the unit in which the expectation is written
};

/// `VARIABLE OP QUANTITY` with OP one of < <= > >=; every element of the variable must satisfy it. Around the
/// variable may stand |bars|: the magnitude. The quantity is converted to the variable's unit.
class Expectation {
 public:
  /// Refuses an unknown variable, a unit that measures something else, and what is no comparison. Context: setup.
  static Result<Expectation> parse(const std::string& text, const Configuration& configuration,
                                   const UnitSystem& units);
  /// As parse(), but a refusal does not repeat `text`.
  static Result<Expectation> read(const std::string& text, const Configuration& configuration,
                                  const UnitSystem& units);
  /// One that parse() has accepted elsewhere, whose bound was `bound`. Refuses what is no comparison. Context: setup.
  static Result<Expectation> with_bound(const std::string& text, const Bound& bound);

  /// True when the value satisfies the expectation; `said` contains the value, in the unit of the expectation. A value
  /// that was never written, or is NaN, satisfies no expectation.
  bool holds(const Seen& seen, std::string& said) const;
  /// "3.1 mrad": values of the variable in the unit of the expectation; `as_is` if that is the unit of the variable.
  std::string value_text(const std::vector<double>& values, const std::string& as_is) const;
  const std::string& text() const noexcept { return text_; }
  const std::string& variable() const noexcept { return variable_; }
  const Bound& bound() const noexcept { return bound_; }

 private:
  std::string text_, variable_, op_;
  Bound bound_;
  bool magnitude_ = false;
};

}  // namespace chimera::cli
