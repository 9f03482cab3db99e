// SPDX-License-Identifier: Apache-2.0
// The text of a description with other values under `operator:`; all else in it stays, comments and layout included.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/units/unit_system.h"

namespace chimera::cli {

/// `text` with the values under `operator:` replaced by those of `values` (name -> words of a description). A value
/// that says the same already, in whatever units, is left as it is written. Refuses: a text that cannot be read, a
/// name that is not there. Context: setup.
Result<std::string> with_operator_values(std::string_view text, const std::map<std::string, std::string>& values,
                                         const UnitSystem& units);

}  // namespace chimera::cli
