// SPDX-License-Identifier: Apache-2.0
// The values that a sweep gives to one name: "kp = 1, 2, 5 N.m/rad", "kp = [0.1:0.1:1.0] N.m/rad".
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "chimera/base/result.h"

namespace chimera::cli {

struct ValueList {
  std::string name;
  std::string unit;                 ///< what stands behind every value; "": nothing, or not behind all the same
  std::vector<std::string> values;  ///< each with its unit
  std::vector<std::string> shown;   ///< each without the unit that all have
  std::vector<double> numbers;      ///< of those; empty when one is no number
};

inline constexpr std::size_t kMostRuns = 100'000;

/// `NAME = VALUE, VALUE, ... UNIT`; a value may be a range `[FIRST:STEP:LAST]`, both ends included. A value without a
/// unit has that of the last one. `is_single(NAME)`: the name has one element, so `[1 2] UNIT` lists two values.
/// Refuses an empty list, a range that does not end, and more than kMostRuns values. Context: setup.
Result<ValueList> parse_value_list(const std::string& text,
                                   const std::function<bool(const std::string& name)>& is_single = nullptr);

}  // namespace chimera::cli
