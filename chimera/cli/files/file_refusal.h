// SPDX-License-Identifier: Apache-2.0
// The form in which the commands on files print an error.
#pragma once

#include <string>

#include "chimera/base/result.h"
#include "chimera/cli/command/command_result.h"
#include "chimera/text/json_text.h"

namespace chimera::cli {

/// "arm.yaml:3:4: error: message", for standard error. Context: setup.
std::string error_line(const Error& error);
/// A result that only says `error`, as text or as {"error": {...}}.
CommandResult file_refusal(const Error& error, bool json, int code = kRefused);

}  // namespace chimera::cli
