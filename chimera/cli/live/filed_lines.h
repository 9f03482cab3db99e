// SPDX-License-Identifier: Apache-2.0
// Receipts or events of a subsystem that does not run, from their file.
#pragma once

#include <string>
#include <vector>

#include "chimera/base/result.h"

namespace chimera::cli {

/// Lines of JSON, and the place that they come from. Plain value.
struct FiledLines {
  std::string subsystem, path;
  std::vector<std::string> lines;  ///< at least one

  /// For standard error: "'drive' does not run: from PATH".
  std::string source() const { return "'" + subsystem + "' does not run: from " + path + "\n"; }
};

/// The last `n` lines of the file `stem` ("receipts" or "events", also the name of the command). `subsystem`: "" stands
/// for the only one that has such a file. `why`: the reason why no subsystem answers. Refuses with it if the subsystem
/// may run, or has no such lines. Context: setup; may block.
Result<FiledLines> filed_lines(const std::string& stem, const std::string& subsystem, std::size_t n, const Error& why);

}  // namespace chimera::cli
