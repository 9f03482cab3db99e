// SPDX-License-Identifier: Apache-2.0
// The limits that bound the work of the YAML parser, checked on the raw bytes in one pass.
#pragma once

#include <string_view>

#include "chimera/description/report.h"

namespace chimera {

/// The remedy for a byte 0, which YAML can write as "\0": a reader of the text would stop at it.
inline constexpr const char* kNoZero = "leave it out: no file, device or name has one";

/// Adds every breach of the limits to `report`. False if the parser must not read the text. It counts everywhere, even
/// in quotes and comments, so that no text evades a limit. Context: setup; O(size), no memory.
bool check_text_limits(std::string_view text, Report& report);

}  // namespace chimera
