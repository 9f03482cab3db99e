// SPDX-License-Identifier: Apache-2.0
// Adds and removes blanks at the ends of a text.
#include "chimera/cli/files/blanks.h"

#include <algorithm>

namespace chimera::cli {

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

}  // namespace chimera::cli
