// SPDX-License-Identifier: Apache-2.0
// One line of a menu, as the constant `item` has it.
#pragma once

#include <cstdint>
#include <tuple>

#include "chimera/task/component.h"

namespace chimera::library {

struct MenuItem {
  Text<24> label;
  Text<8> kind;             ///< class of the menu object: text, show, edit or go
  std::int32_t screen = 0;  ///< the screen that the line stands on
  std::int32_t number = 0;  ///< of the value that is shown or edited, or of the screen that `go` leads to
  std::int32_t digits = 6;  ///< significant digits of the value
};

}  // namespace chimera::library

template <>
struct chimera::Fields<chimera::library::MenuItem> {
  using MenuItem = chimera::library::MenuItem;
  static constexpr const char* name = "menu_item";
  static constexpr auto list =
      std::tuple{field("label", "1", &MenuItem::label), field("kind", "1", &MenuItem::kind),
                 field("screen", "1", &MenuItem::screen), field("number", "1", &MenuItem::number),
                 field("digits", "1", &MenuItem::digits)};
};
