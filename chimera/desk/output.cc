// SPDX-License-Identifier: Apache-2.0
// Makes the output of a command that refuses.
#include "chimera/desk/output.h"

#include "chimera/base/hosted/terminal_text.h"

namespace chimera::desk {

std::string error_line(const Error& error) {
  std::string text(error.where.view());
  text += text.empty() ? "error: " : ": error: ";
  text += error.message.view();
  return for_terminal(text) + "\n";
}

CommandResult refused(const Error& error, bool json, int code) {
  CommandResult output;
  output.code = code;
  if (json)
    output.out = "{\"error\": {\"where\": " + json_string(error.where.view()) +
                 ", \"message\": " + json_string(error.message.view()) + "}}\n";
  else
    output.err = error_line(error);
  return output;
}

}  // namespace chimera::desk
