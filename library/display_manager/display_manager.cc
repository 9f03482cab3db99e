// SPDX-License-Identifier: Apache-2.0
// Menus on a text terminal: its cycle is the framework of menu objects (2000 paper, section 7). Keys come in and bytes
// go out through ports, so that a UART, a terminal and a test serve the same source. README.md is the data sheet.
#include <array>

#include "chimera/base/math.h"
#include "chimera/task/component.h"
#include "chimera/task/number_at.h"
#include "library/display_manager/menu.h"

using namespace chimera;
using library::EditedValue, library::Keys, library::Menu, library::MenuBoard, library::MenuItem;

namespace {

constexpr std::size_t kKeys = 16, kBytes = 64;
constexpr std::uint32_t kEdited = 8;  // a component has 64 ports
static_assert(kBytes >= library::Picture::kLeast);

struct Menus {
  Many<In<Any[]>> shown{"shown*", "X", "[n...<=64]", type = "T", doc = "Of the lines `show`: the first element."};
  In<Text<kKeys + 4>> keys{"keys", "1", initial = "", doc = "Bytes of the keyboard, at most 16 a cycle."};
  Many<Out<double>, kEdited> edited{"edited*", "Y", initial = 0.0, doc = "Values of the lines `edit`."};
  Out<Text<kBytes + 4>> output{"output", "1", initial = "", doc = "Bytes for the terminal, new in each cycle."};
  Out<std::int64_t> sent{"sent", "1", initial = 0, doc = "Bytes of all outputs so far."};
  InConst<Text<32>[]> screen{"screen", "1", "[screens<=8]", doc = "Titles of the screens."};
  InConst<MenuItem[]> item{"item", "1", "[items<=32]", doc = "The lines, from top to bottom."};
  Many<InConst<double>, kEdited> preset{"preset*", "Y", doc = "Of each edited value, until it is edited."};
  Many<InConst<double>, kEdited> minimum{"minimum*", "Y", doc = "Of each edited value."};
  Many<InConst<double>, kEdited> maximum{"maximum*", "Y", doc = "Of each edited value."};
  Many<InConst<double>, kEdited> step{"step*", "Y", doc = "Of each edited value, for an arrow key."};

  Outcome init() {
    keys_ = {};
    menu_.board() = {};
    return reinit();
  }
  // An edited value stays if the new limits allow it.
  Outcome reinit() {
    MenuBoard& board = menu_.board();
    board.n_shown = shown.size();
    board.n_edited = edited.size();
    board.n_screens = screen.size();
    for (const auto& port : shown)
      if (port.element_type() > CHIMERA_FLOAT64) return fault("texts and structs cannot be shown");
    for (const std::size_t n : {preset.size(), minimum.size(), maximum.size(), step.size()})
      if (n != edited.size()) return fault("each edited value needs preset, minimum, maximum and step");
    for (std::size_t i = 0; i < edited.size(); ++i)
      if (const char* why = take(i, board.edited[i])) return fault(why);
    if (const char* why = menu_.begin(item.span())) return fault(why);
    return ok();
  }
  // The values stand when a task took over, and after off and on.
  void on(Cycle c) {
    for (std::size_t i = 0; i < edited.size(); ++i) {
      EditedValue& value = menu_.board().edited[i];
      value.unit = c.unit(edited[i]);
      if (edited[i].inherited() != kNever && value.may_be(*edited[i])) value.value = *edited[i];
      *edited[i] = value.value;
    }
    for (std::size_t i = 0; i < shown.size(); ++i) menu_.board().shown[i].unit = c.unit(shown[i]);
    menu_.restart();
    *output = "";
  }
  void cycle() {
    if (keys.fresh() && !keys->empty()) {
      for (const char byte : keys->view()) menu_.press(item.span(), keys_.take(byte));
    } else {
      menu_.press(item.span(), keys_.rest());
    }
    for (std::size_t i = 0; i < shown.size(); ++i) {
      menu_.board().shown[i].is_valid = shown[i].valid();
      menu_.board().shown[i].value = number_at(shown[i].element_type(), shown[i].bytes().data());
    }
    std::array<char, kBytes> bytes;
    const std::size_t n = menu_.draw(item.span(), screen[menu_.board().screen].view(), bytes);
    *output = Text<kBytes + 4>(std::string_view(bytes.data(), n));
    *sent += static_cast<std::int64_t>(n);
    for (std::size_t i = 0; i < edited.size(); ++i) *edited[i] = menu_.board().edited[i].value;
  }

 private:
  // Returns what is wrong with the limits of that edited value.
  const char* take(std::size_t i, EditedValue& to) const {
    to.minimum = *minimum[i];
    to.maximum = *maximum[i];
    to.step = *step[i];
    if (!math::is_finite(to.minimum) || !math::is_finite(to.maximum)) return "minimum and maximum are finite";
    if (!to.may_be(*preset[i])) return "preset lies between minimum and maximum";
    if (!to.may_be(to.value)) to.value = *preset[i];
    return to.step > 0 && math::is_finite(to.step) ? nullptr : "step is above 0";
  }

  Menu menu_;
  Keys keys_;
};

CHIMERA_COMPONENT(Menus, "display_manager", "Menus on a text terminal, which show and edit values.",
                  rate = 20.0, source = "2000 paper, section 7");

}  // namespace
