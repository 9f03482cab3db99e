// SPDX-License-Identifier: Apache-2.0
// Makes the output of a command that refuses.
#include "chimera/cli/files/file_refusal.h"

#include "chimera/base/hosted/terminal_text.h"

namespace chimera::cli {

std::string error_line(const Error& error) {
  std::string text(error.where.view());
  text += text.empty() ? "error: " : ": error: ";
  text += error.message.view();
  return for_terminal(text) + "\n";
}

CommandResult file_refusal(const Error& error, bool json, int code) {
  CommandResult output;
  output.code = code;
  if (json)
    output.out = spaced_json({{"error", {{"where", error.where.view()}, {"message", error.message.view()}}}}) + "\n";
  else
    output.err = error_line(error);
  return output;
}

}  // namespace chimera::cli
