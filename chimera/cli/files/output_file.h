// SPDX-License-Identifier: Apache-2.0
// Files that a command writes at its end, and asks about at its beginning: better now than after an hour.
#pragma once

#include <string>

#include "chimera/base/result.h"

namespace chimera::cli {

/// Whether the file can be written; it is left as it is. No path: nothing to do. Context: setup; may block.
Result<void> may_write(const std::string& path);
/// Writes it. No path: nothing to do. Context: setup; may block.
Result<void> write_whole(const std::string& path, const std::string& text);

}  // namespace chimera::cli
