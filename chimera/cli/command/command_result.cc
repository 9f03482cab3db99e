// SPDX-License-Identifier: Apache-2.0
// Prints the result of a command: standard output first, then standard error.
#include "chimera/cli/command/command_result.h"

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/platform/standard_streams.h"

namespace chimera::cli {

int print(const CommandResult& result, std::FILE* out, std::FILE* err) {
  std::fputs(for_terminal(result.out).c_str(), out);
  (void)flush_and_look(out);  // in a file that takes both, what came first stands first
  std::fputs(for_terminal(result.err).c_str(), err);
  return result.code;
}

}  // namespace chimera::cli
