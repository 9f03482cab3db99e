// SPDX-License-Identifier: Apache-2.0
// A typed line, cut into words; and the words that could stand at the cursor.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/cli/command/command.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// Cuts at spaces; '...' and "..." keep them, a backslash outside '...' keeps the next letter, # begins a comment where
/// a word could begin. Refuses a quote that is not closed. Context of all: setup.
Result<std::vector<std::string>> words_of(std::string_view line);

/// The names that the shell can complete, from the answer `describe`.
struct Names {
  std::vector<std::string> tasks, variables, operators, configurations;
};
Names names_of(const Json& described);

/// Completions of the last word of `before` (the line up to the cursor), whole words in order: commands at the
/// beginning, then words that the command takes.
std::vector<std::string> completions(Table table, std::string_view before, const Names& names);
/// The longest beginning that all of them share.
std::string shared_beginning(const std::vector<std::string>& words);

}  // namespace chimera::cli
