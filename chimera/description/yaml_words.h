// SPDX-License-Identifier: Apache-2.0
// Values as a description writes them in one line, with quotes where YAML needs them.
#pragma once

#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/description/node.h"

namespace chimera {

/// True if YAML reads `text`, without quotes, as another text or not at all; `in_brackets`: inside of [] or {}.
/// Context: setup; parses the text.
bool needs_quotes(std::string_view text, bool in_brackets);

/// `text` in quotes: `quote` is ' or ". A text that ' cannot hold gets ". Context: setup.
std::string quoted_words(std::string_view text, char quote);

/// A value in one line: "5 m", "[1, 2]", "{x: 1 m}". Context: setup.
std::string written_text(const Node& value, bool in_brackets = false);

/// The value that these words of a description say, without places. A text that cannot stand in brackets without quotes
/// counts as written in quotes. Refuses words that YAML cannot read, two lines, and
/// no value. Context: setup.
Result<Node> value_of(std::string_view words);

/// True if both trees say the same; places are ignored. Context: setup.
bool is_same(const Node& a, const Node& b);

}  // namespace chimera
