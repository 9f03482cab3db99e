// SPDX-License-Identifier: Apache-2.0
// The classes of menu objects: lines of text, shown and edited values, ways to other screens. The framework (menu.h)
// calls their methods as the framework of tasks calls those of components. An object has no state of its own: its item
// is a constant, and all that changes is on the board. A new class is one struct here and a line in class_of().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include "chimera/base/fixed.h"
#include "chimera/base/number_text.h"
#include "library/display_manager/keys.h"
#include "library/display_manager/menu_item.h"

namespace chimera::library {

/// A value that is shown. Plain value.
struct ShownValue {
  double value = 0;
  bool is_valid = false;
  FixedString<8> unit;
};

/// A value that a person edits. Plain value.
struct EditedValue {
  double value = kNone, minimum = 0, maximum = 0, step = 0;
  FixedString<8> unit;

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  bool may_be(double other) const noexcept { return other >= minimum && other <= maximum; }
};

/// The values that all menu objects see and change. Plain value.
struct MenuBoard {
  static constexpr std::size_t kValues = 16;
  std::array<ShownValue, kValues> shown;
  std::array<EditedValue, kValues> edited;
  std::size_t n_shown = 0, n_edited = 0, n_screens = 0;
  std::size_t screen = 0;      ///< the one that is shown
  FixedString<12> entry;       ///< what was typed so far; empty: the edited value stands
  bool is_wrong = false;       ///< the entry was no number, or out of range
};

/// The right half of a line.
using MenuText = FixedString<20>;

/// Context of everything: cycle; wait-free; no allocation.
struct MenuObject {
  /// False: the item names a value or screen that is not there. Context: setup.
  virtual bool fits(const MenuItem& item, const MenuBoard& board) const noexcept = 0;
  /// Text at the right end of its line. `is_open`: the object has the keys.
  virtual MenuText text(const MenuItem& item, const MenuBoard& board, bool is_open) const noexcept = 0;
  /// Enter on its line. True: from now on the object has the keys.
  virtual bool open(const MenuItem& /*item*/, MenuBoard& /*board*/) const noexcept { return false; }
  /// One key. False: it gives the keys back.
  virtual bool press(const MenuItem& /*item*/, Pressed /*pressed*/, MenuBoard& /*board*/) const noexcept {
    return false;
  }

 protected:
  ~MenuObject() = default;
};

/// Number and unit, the unit as far as it fits.
inline MenuText text_of(double value, std::int32_t digits, std::string_view unit) noexcept {
  const FixedString<24> number = number_text(value, digits);
  char bytes[MenuText::capacity()];
  std::size_t n = 0;
  const auto add = [&](std::string_view part) {
    for (const char c : part)
      if (n < sizeof bytes) bytes[n++] = c;
  };
  add(number.view());
  if (!unit.empty() && unit != "1") add(" "), add(unit);
  return MenuText(std::string_view(bytes, n));
}

struct PlainLine final : MenuObject {
  bool fits(const MenuItem&, const MenuBoard&) const noexcept override { return true; }
  MenuText text(const MenuItem&, const MenuBoard&, bool) const noexcept override { return {}; }
};

struct ShowLine final : MenuObject {
  bool fits(const MenuItem& item, const MenuBoard& board) const noexcept override {
    return item.number >= 0 && static_cast<std::size_t>(item.number) < board.n_shown;
  }
  MenuText text(const MenuItem& item, const MenuBoard& board, bool) const noexcept override {
    const ShownValue& shown = board.shown[static_cast<std::size_t>(item.number)];
    if (!shown.is_valid) return MenuText("-");
    return text_of(shown.value, item.digits, shown.unit.view());
  }
};

/// Enter begins. Arrows step the value at once. Of a number that is typed, Enter takes it, and ESC leaves the old one.
struct EditLine final : MenuObject {
  bool fits(const MenuItem& item, const MenuBoard& board) const noexcept override {
    return item.number >= 0 && static_cast<std::size_t>(item.number) < board.n_edited;
  }
  MenuText text(const MenuItem& item, const MenuBoard& board, bool is_open) const noexcept override {
    const EditedValue& edited = board.edited[static_cast<std::size_t>(item.number)];
    if (!is_open) return text_of(edited.value, item.digits, edited.unit.view());
    if (board.is_wrong) return MenuText("out of range");
    return board.entry.empty() ? text_of(edited.value, item.digits, edited.unit.view()) : MenuText(board.entry.view());
  }
  bool open(const MenuItem&, MenuBoard& board) const noexcept override {
    board.entry = {};
    board.is_wrong = false;
    return true;
  }
  bool press(const MenuItem& item, Pressed pressed, MenuBoard& board) const noexcept override {
    EditedValue& edited = board.edited[static_cast<std::size_t>(item.number)];
    board.is_wrong = false;
    switch (pressed.key) {
      case Key::kText: add(board.entry, pressed.text); return true;
      case Key::kErase: erase(board.entry); return true;
      case Key::kMore: case Key::kUp: return step(edited, board, edited.step);
      case Key::kLess: case Key::kDown: return step(edited, board, -edited.step);
      case Key::kEnter: return !board.entry.empty() && !take(edited, board);
      case Key::kCancel: return false;
      default: return true;
    }
  }

 private:
  static void add(FixedString<12>& entry, char c) noexcept {
    const bool is_part = (c >= '0' && c <= '9') || c == '.' || c == '-' || c == 'e';
    if (!is_part || entry.view().size() == entry.capacity()) return;
    char bytes[FixedString<12>::capacity()];
    std::size_t n = 0;
    for (const char each : entry.view()) bytes[n++] = each;
    bytes[n++] = c;
    entry.assign({bytes, n});
  }
  static void erase(FixedString<12>& entry) noexcept {
    const FixedString<12> before = entry;
    if (!before.empty()) entry.assign(before.view().substr(0, before.view().size() - 1));
  }
  static bool step(EditedValue& edited, MenuBoard& board, double by) noexcept {
    board.entry = {};
    const double next = edited.value + by;
    edited.value = next > edited.maximum ? edited.maximum : next < edited.minimum ? edited.minimum : next;
    return true;
  }
  static bool take(EditedValue& edited, MenuBoard& board) noexcept {
    const ReadNumber read = read_number(board.entry.view());
    const bool is_good = read.length == board.entry.view().size() && read.in_range && edited.may_be(read.value);
    board.is_wrong = !is_good;
    board.entry = {};
    if (is_good) edited.value = read.value;
    return is_good;
  }
};

struct GoLine final : MenuObject {
  bool fits(const MenuItem& item, const MenuBoard& board) const noexcept override {
    return item.number >= 0 && static_cast<std::size_t>(item.number) < board.n_screens;
  }
  MenuText text(const MenuItem&, const MenuBoard&, bool) const noexcept override { return MenuText(">"); }
  bool open(const MenuItem& item, MenuBoard& board) const noexcept override {
    board.screen = static_cast<std::size_t>(item.number);
    return false;
  }
};

/// The class of that kind; null: there is none. Context: setup.
inline const MenuObject* class_of(std::string_view kind) noexcept {
  static constexpr PlainLine kText;
  static constexpr ShowLine kShow;
  static constexpr EditLine kEdit;
  static constexpr GoLine kGo;
  if (kind == "text") return &kText;
  if (kind == "show") return &kShow;
  if (kind == "edit") return &kEdit;
  return kind == "go" ? &kGo : nullptr;
}

}  // namespace chimera::library
