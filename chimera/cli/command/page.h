// SPDX-License-Identifier: Apache-2.0
// Pages made from the table of commands: the manual and the completion for bash.
#pragma once

#include <string>

#include "chimera/base/result.h"
#include "chimera/cli/command/command.h"

namespace chimera::cli {

/// `text` with each of these lines replaced by what the rows of `table` give; no row that is hidden:
///   @synopsis@  the calls, and
///   @commands@  a section .SS for each command, for the manual (roff, man(7))
///   @words@     the options and commands of each command, and
///   @takes@     what each command and option takes, as branches of a `case` of bash
/// Refuses another line of that form. Context: setup.
Result<std::string> page(const std::string& text, Table table);

}  // namespace chimera::cli
