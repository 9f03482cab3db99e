// SPDX-License-Identifier: Apache-2.0
// The framework that runs menu objects: passes keys to the object that has them, moves between lines and screens, and
// draws.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "chimera/task/component.h"
#include "library/display_manager/menu_object.h"
#include "library/display_manager/picture.h"

namespace chimera::library {

/// The lines stay where they are: each method gets the same ones. Context of everything not marked: cycle; O(lines);
/// no allocation.
class Menu {
 public:
  static constexpr std::size_t kMostItems = 32, kMostScreens = 8;
  /// Lines below the title of the screen.
  static constexpr std::size_t kRows = Picture::kRows - 1;
  using Items = std::span<const MenuItem>;

  /// Begins with these lines; returns what is wrong with them. The board has the limits of the edited values, and how
  /// many values and screens there are. Requires: at most kMostItems and kMostScreens. Context: setup.
  const char* begin(Items items) noexcept {
    selected_ = {};
    board_.screen = 0;
    is_open_ = false;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const MenuItem& item = items[i];
      objects_[i] = class_of(item.kind.view());
      if (objects_[i] == nullptr) return "the kind of a menu item is text, show, edit or go";
      if (item.screen < 0 || static_cast<std::size_t>(item.screen) >= board_.n_screens)
        return "a menu item stands on a screen that is not there";
      if (!objects_[i]->fits(item, board_)) return "a menu item names a value or screen that is not there";
      if (item.digits < 1 || item.digits > 15) return "digits of a menu item are 1 to 15";
    }
    return nullptr;
  }
  MenuBoard& board() noexcept { return board_; }
  /// The terminal shows anything, and no object has the keys.
  void restart() noexcept {
    is_open_ = false;
    picture_.forget();
  }

  void press(Items items, Pressed pressed) noexcept {
    if (pressed.key == Key::kNone) return;
    if (pressed.key == Key::kRepaint) return picture_.forget();
    std::size_t& at = selected_[board_.screen];
    const std::size_t i = find(items, at);
    if (is_open_) {
      is_open_ = objects_[i]->press(items[i], pressed, board_);
      return;
    }
    if (pressed.key == Key::kUp && at > 0) --at;
    if (pressed.key == Key::kDown && find(items, at + 1) < items.size()) ++at;
    if (pressed.key == Key::kCancel) board_.screen = 0;
    if (pressed.key == Key::kEnter && i < items.size()) is_open_ = objects_[i]->open(items[i], board_);
  }
  /// Draws, and writes at most `to.size()` bytes for the terminal; returns how many. Requires: as Picture::tell().
  std::size_t draw(Items items, std::string_view title, std::span<char> to) noexcept {
    picture_.blank(0);
    picture_.put(0, 0, title);
    const std::size_t at = selected_[board_.screen];
    const std::size_t first = at < kRows ? 0 : at - kRows + 1;
    for (std::size_t row = 0; row < kRows; ++row) {
      picture_.blank(row + 1);
      const std::size_t i = find(items, first + row);
      if (i < items.size()) draw(items[i], *objects_[i], row + 1, first + row == at);
    }
    return picture_.tell(to);
  }

 private:
  void draw(const MenuItem& item, const MenuObject& object, std::size_t row, bool is_selected) noexcept {
    const bool is_open = is_selected && is_open_;
    const MenuText text = object.text(item, board_, is_open);
    const std::size_t column = Picture::kColumns - text.view().size();
    if (is_selected) picture_.put(row, 0, is_open ? "*" : ">");
    picture_.put(row, 1, item.label.view());
    if (!text.empty()) picture_.put(row, column - 1, " ");
    picture_.put(row, column, text.view());
  }
  /// The item of the line of that number on the present screen; items.size(): there is none.
  std::size_t find(Items items, std::size_t number) const noexcept {
    std::size_t i = 0;
    for (; i < items.size(); ++i)
      if (static_cast<std::size_t>(items[i].screen) == board_.screen && number-- == 0) break;
    return i;
  }

  std::array<const MenuObject*, kMostItems> objects_{};
  std::array<std::size_t, kMostScreens> selected_{};  // lines of each screen
  MenuBoard board_;
  Picture picture_;
  bool is_open_ = false;  // the object of the selected line has the keys
};

}  // namespace chimera::library
