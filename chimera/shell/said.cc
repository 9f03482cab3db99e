// SPDX-License-Identifier: Apache-2.0
#include "chimera/shell/said.h"

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/platform/standard_output.h"

namespace chimera::shell {

int print(const Said& said, std::FILE* out, std::FILE* err) {
  std::fputs(for_terminal(said.out).c_str(), out);
  (void)flush_and_look(out);  // in a file that takes both, what came first stands first
  std::fputs(for_terminal(said.err).c_str(), err);
  return said.code;
}

}  // namespace chimera::shell
