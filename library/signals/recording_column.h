// SPDX-License-Identifier: Apache-2.0
// Names of the columns of a recording: "q[0]", "m[1][2]", "speed".
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "chimera/task/component.h"

namespace chimera::library {

/// Text without blank and comma, so that a reader that guesses the separator finds the comma. Context: setup.
inline std::string column_text(std::string_view text) {
  std::string made(text);
  for (char& c : made)
    if (c == ' ' || c == ',') c = '.';
  return made;
}

/// Index of element `i` of a port behind the name of its variable; a scalar has none. Context: setup.
inline std::string column_index(const chimera_port& port, std::size_t i) {
  if (port.count == 1) return "";
  if (port.extent[1] == 1) return "[" + std::to_string(i) + "]";
  return "[" + std::to_string(i / port.extent[1]) + "][" + std::to_string(i % port.extent[1]) + "]";
}

}  // namespace chimera::library
