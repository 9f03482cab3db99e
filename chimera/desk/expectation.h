// SPDX-License-Identifier: Apache-2.0
// What a run must have reached at its end, so that its exit code says whether it was good: "error <= 2 mrad".
#pragma once

#include <span>
#include <string>

#include "chimera/config/unit_system.h"
#include "chimera/desk/application.h"

namespace chimera::desk {

/// `VARIABLE OP QUANTITY` with OP one of < <= > >=; every element of the variable must satisfy it. Around the
/// variable may stand |bars|: the magnitude. The quantity is converted to the variable's unit.
class Expectation {
 public:
  /// Refuses an unknown variable, a unit that measures something else, and what is no comparison. Context: setup.
  static Result<Expectation> parse(const std::string& text, const Application& application, const UnitSystem& units);

  /// True when the present value satisfies it; `said` tells the value and the bound. A value that was never
  /// written, or is NaN, satisfies nothing.
  bool holds(std::string& said) const;
  const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
  Probe probe_;
  std::string op_;
  double bound_ = 0;
  bool magnitude_ = false;
};

}  // namespace chimera::desk
