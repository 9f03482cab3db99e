// SPDX-License-Identifier: Apache-2.0
// The limits that bound the work of the YAML parser, checked on the raw bytes in one pass.
#pragma once

#include <string_view>

#include "chimera/description/report.h"

namespace chimera {

/// What to do about a byte 0, which YAML can write as "\0": whoever takes the text would see it end there.
inline constexpr const char* kNoZero = "leave it out: no file, device or name has one";

/// Adds to `report` every breach of the limits of the text. False when the parser must not see it.
/// What it counts is counted wherever it stands, in quotes and comments too, so nothing can hide from it.
/// Context: setup; O(size), no memory.
bool check_text_limits(std::string_view text, Report& report);

}  // namespace chimera
