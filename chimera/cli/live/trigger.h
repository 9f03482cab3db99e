// SPDX-License-Identifier: Apache-2.0
// When a scope begins: "error > 2 mrad", "|q[2]| >= 0.5 rad", "mode == 3". It fires at the edge, the first moment at
// which the comparison holds after one at which it did not.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/cli/live/channel.h"
#include "chimera/units/quantity.h"

namespace chimera::cli {

enum class Comparison : char { kAbove, kAtLeast, kBelow, kAtMost, kEqual, kUnequal };

/// Plain value with the memory of the last look.
class Trigger {
 public:
  /// Reads VARIABLE OP QUANTITY, the quantity in any unit that can be converted. Refuses, saying what was found: no
  /// variable, no comparison, no quantity. Context of all: setup.
  static Result<Trigger> read(std::string_view text, const UnitSystem& units);

  const ChannelName& channel() const noexcept { return channel_; }
  const std::string& text() const noexcept { return text_; }
  /// The level in the unit of the variable; refuses a unit that measures something else.
  Result<double> settle(std::string_view unit, const UnitSystem& units);
  double level() const noexcept { return level_; }
  /// True when the comparison becomes true. A value that is not a number holds no comparison. Requires: settled.
  bool fires(double value) noexcept;

 private:
  ChannelName channel_;
  Comparison comparison_ = Comparison::kAbove;
  bool is_absolute_ = false;
  Quantity quantity_;
  std::string text_;
  double level_ = 0;
  std::optional<bool> held_;
};

}  // namespace chimera::cli
