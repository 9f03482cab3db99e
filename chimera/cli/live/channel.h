// SPDX-License-Identifier: Apache-2.0
// A variable, or a part of one, as a set of numbers: "q" is all of its elements, "q[2]" one, "pose.x" a field.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// The variable, or part of one, that the user asked for. Plain value.
struct ChannelName {
  std::string variable;
  std::string part;  ///< "", "[2]", ".x", "[1].y[0]"
};

/// Reads the name of a variable and its part. Refuses what is none, saying what
/// was found. Context of all: setup.
Result<ChannelName> read_channel(std::string_view text);

/// A number of a value and the part that it is.
struct ChannelNumber {
  std::string part;
  double value = 0;  ///< NaN for null
};

/// Every number under `part` of a value as docs/formats/control.md has it; a truth is 0 or 1; texts give none. Empty
/// when there is no such element.
std::vector<ChannelNumber> numbers_of(const Json& value, const std::string& part);

}  // namespace chimera::cli
