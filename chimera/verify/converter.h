// SPDX-License-Identifier: Apache-2.0
// The component of the library that converts one unit to another.
#pragma once

#include <optional>
#include <string>

#include "chimera/catalogue/library.h"

namespace chimera {

struct Converter {
  std::string component, in, out;  ///< with its two ports
  std::string factor = {};         ///< value of its constant `factor`: "1000 m/km"; empty: it has none
};

/// A unit and its text.
struct WordedUnit {
  Unit unit;
  std::string text;
};

/// A component for just these two units, otherwise unit_convert with its factor; none if the library has neither.
/// Context: setup.
std::optional<Converter> converter_of(const Library& library, const WordedUnit& from, const WordedUnit& to);

}  // namespace chimera
