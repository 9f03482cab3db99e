// SPDX-License-Identifier: Apache-2.0
// Makes texts safe to print on a terminal. Names, sentences, units and faults of components come from outside the
// framework. Such a text must not move the cursor, set a title, or change the direction of the text beside it.
#pragma once

#include <string>
#include <string_view>

namespace chimera {

/// `text` as one line: a space for each control character (C0, DEL, C1, line ends too), each mark of direction
/// (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069), each character without a width (U+200B to U+200D,
/// U+2060 to U+2064, U+FEFF), each separator of lines (U+2028, U+2029), and each byte that is no UTF-8.
/// Context: setup.
std::string plain_line(std::string_view text);

/// JSON in which each of these characters of a text is its escape, such as \u202e: its values stay as they are.
/// Context: setup.
std::string plain_json(std::string_view json);

/// `text` in the form that a command prints. A JSON object is changed as plain_json() does. Other text is changed as
/// plain_line() does, but keeps its line ends and tabs. Context: setup.
std::string for_terminal(std::string_view text);

}  // namespace chimera
