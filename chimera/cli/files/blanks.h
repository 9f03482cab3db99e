// SPDX-License-Identifier: Apache-2.0
// Blanks around a text: added for columns, taken off what the user wrote. Context: setup.
#pragma once

#include <cstddef>
#include <string>

namespace chimera::cli {

/// At least `width` bytes, filled with blanks at the end.
std::string padded(std::string text, std::size_t width);
/// Without the blanks before and behind it.
std::string trimmed(const std::string& text);

}  // namespace chimera::cli
