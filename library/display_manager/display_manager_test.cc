// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "chimera/task/rig.h"
#include "library/display_manager/menu_item.h"
#include "library/display_manager/picture.h"

namespace chimera {
namespace {

using library::MenuItem;
using library::Picture;

/// A terminal that understands what a Picture says, and nothing else.
class Terminal {
 public:
  Terminal() { rows_.fill(std::string(Picture::kColumns, '#')); }
  void take(std::string_view bytes) {
    for (const char c : bytes) take(c);
  }
  /// Without blanks at its end.
  std::string row(std::size_t number) const {
    const std::string& row = rows_.at(number);
    return row.substr(0, row.find_last_not_of(' ') + 1);
  }

 private:
  void take(char c) {
    if (c == '\x1b') command_ = "";
    if (command_) {
      *command_ += c;
      if (std::isalpha(static_cast<unsigned char>(c)) == 0) return;
      carry_out(*command_);
      command_.reset();
      return;
    }
    rows_.at(row_).at(column_++) = c;
  }
  void carry_out(const std::string& command) {
    unsigned row = 0, column = 0;
    if (command == "\x1b[2J") rows_.fill(std::string(Picture::kColumns, ' '));
    else if (std::sscanf(command.c_str(), "\x1b[%u;%uH", &row, &column) == 2) row_ = row - 1, column_ = column - 1;
    else EXPECT_EQ(command, "\x1b[?25l");
  }

  std::array<std::string, Picture::kRows> rows_;
  std::optional<std::string> command_;
  std::size_t row_ = 0, column_ = 0;
};

const std::vector<MenuItem> kItems{{"speed", "show", 0, 0, 4},
                                   {"settings", "go", 0, 1, 1},
                                   {"wanted", "edit", 1, 0, 4},
                                   {"back", "go", 1, 0, 1}};

struct Car {
  Rig rig{"display_manager"};
  Terminal terminal;
  std::int64_t told = 0;

  explicit Car(bool has_speed = true, const std::vector<MenuItem>& items = kItems) {
    rig.instances("shown", 1);
    rig.extent("n", 1);
    for (const char* port : {"edited", "preset", "minimum", "maximum", "step"}) rig.instances(port, 1);
    rig.joined("shown", "speed", "m/s");
    rig.joined("edited", "wanted", "m/s");
    rig.extent("screens", 2);
    rig.set("screen", Text<32>("cruise control"), 0);
    rig.set("screen", Text<32>("settings"), 1);
    rig.extent("items", static_cast<std::uint32_t>(items.size()));
    for (std::uint32_t i = 0; i < items.size(); ++i) rig.set("item", items[i], i);
    rig.set("preset", 20.0), rig.set("minimum", 0.0), rig.set("maximum", 40.0), rig.set("step", 0.5);
    if (has_speed) rig.set("shown", 21.5);
  }
  void start() {
    ASSERT_TRUE(rig.init());
    ASSERT_TRUE(rig.on());
    settle();
  }
  void cycle() {
    ASSERT_TRUE(rig.cycle());
    const auto output = rig.get<Text<68>>("output");
    told += static_cast<std::int64_t>(output.view().size());
    EXPECT_EQ(rig.get<std::int64_t>("sent"), told);
    terminal.take(output.view());
  }
  /// Cycles until nothing is left to tell.
  void settle() {
    do cycle();
    while (!rig.get<Text<68>>("output").empty() && told < 100'000);
  }
  void press(std::string_view keys) {
    rig.set("keys", Text<20>(keys));
    settle();
  }
  double wanted() { return rig.get<double>("edited"); }
};

TEST(DisplayManager, ShowsItsFirstScreenPieceByPiece) {
  Car car;
  ASSERT_TRUE(car.rig.init());
  ASSERT_TRUE(car.rig.on());
  car.cycle();
  EXPECT_EQ(car.rig.get<Text<68>>("output").view().substr(0, 4), "\x1b[2J");
  EXPECT_LE(car.rig.get<Text<68>>("output").view().size(), 64u);
  EXPECT_EQ(car.terminal.row(1), ">speed                  21.5");
  car.settle();
  EXPECT_EQ(car.terminal.row(0), "cruise control");
  EXPECT_EQ(car.terminal.row(1), ">speed                  21.5 m/s");
  EXPECT_EQ(car.terminal.row(2), " settings                      >");
  EXPECT_EQ(car.terminal.row(3), "");
  car.cycle();
  EXPECT_TRUE(car.rig.get<Text<68>>("output").empty()) << "nothing has changed";
}

TEST(DisplayManager, TellsOnlyWhatHasChanged) {
  Car car;
  car.start();
  car.rig.set("shown", 21.7);
  car.cycle();
  EXPECT_EQ(car.rig.get<Text<68>>("output").view(), "\x1b[2;28H7");
  EXPECT_EQ(car.terminal.row(1), ">speed                  21.7 m/s");
}

TEST(DisplayManager, AnEditedValueIsAnOutput) {
  Car car;
  car.start();
  EXPECT_EQ(car.wanted(), 20) << "preset";
  car.press("\x1b[B\r");
  EXPECT_EQ(car.terminal.row(0), "settings");
  car.press("\r");
  EXPECT_EQ(car.terminal.row(1), "*wanted                   20 m/s");
  car.press("27.25");
  EXPECT_EQ(car.terminal.row(1), "*wanted                    27.25");
  EXPECT_EQ(car.wanted(), 20) << "before Enter";
  car.press("\x7f\r");
  EXPECT_EQ(car.wanted(), 27.2);
  EXPECT_EQ(car.terminal.row(1), ">wanted                 27.2 m/s");
}

TEST(DisplayManager, ArrowsStepAnEditedValueWithinItsLimits) {
  Car car;
  car.start();
  car.press("j\r\r\x1b[C\x1b[C\x1b[D");
  EXPECT_EQ(car.wanted(), 20.5);
  for (int i = 0; i < 10; ++i) car.press("++++++++++++++++");
  EXPECT_EQ(car.wanted(), 40);
}

TEST(DisplayManager, ANumberOutOfRangeChangesNothing) {
  Car car;
  car.start();
  car.press("j\r\r41\r");
  EXPECT_EQ(car.terminal.row(1), "*wanted             out of range");
  EXPECT_EQ(car.wanted(), 20);
  car.press("1-2\r");
  EXPECT_EQ(car.terminal.row(1), "*wanted             out of range") << "no number";
  car.press("1q");
  EXPECT_EQ(car.terminal.row(1), ">wanted                   20 m/s") << "cancelled";
}

TEST(DisplayManager, ALoneEscapeCancelsAndAnArrowMayComeInTwoPieces) {
  Car car;
  car.start();
  car.press("j\r\r3");
  car.rig.set("keys", Text<20>("\x1b"));
  car.cycle();
  car.rig.set("keys", Text<20>("[C"));
  car.cycle();
  EXPECT_EQ(car.wanted(), 20.5);
  car.press("\x1b");
  car.settle();
  EXPECT_EQ(car.terminal.row(1), ">wanted                 20.5 m/s");
  car.press("\x1b");
  car.settle();
  EXPECT_EQ(car.terminal.row(0), "cruise control");
}

TEST(DisplayManager, ANotANumberIsShownAsNan) {
  Car car;
  car.rig.set("shown", std::nan(""));
  car.start();
  EXPECT_EQ(car.terminal.row(1), ">speed                   nan m/s");
}

TEST(DisplayManager, AValueThatWasNeverWrittenIsADash) {
  Car car(false);
  car.start();
  EXPECT_EQ(car.terminal.row(1), ">speed                         -");
}

TEST(DisplayManager, ScrollsAScreenWithMoreLinesThanRows) {
  std::vector<MenuItem> items;
  for (int i = 0; i < 9; ++i) items.push_back({Text<24>("line " + std::to_string(i)), "text", 0, 0, 1});
  Car car(true, items);
  car.start();
  EXPECT_EQ(car.terminal.row(7), " line 6");
  car.press("jjjjjjjjj");
  EXPECT_EQ(car.terminal.row(7), ">line 8");
  EXPECT_EQ(car.terminal.row(1), " line 2");
}

TEST(DisplayManager, ControlLWritesTheWholePictureAgain) {
  Car car;
  car.start();
  car.terminal = {};
  car.press("\f");
  EXPECT_EQ(car.terminal.row(1), ">speed                  21.5 m/s");
}

TEST(DisplayManager, AnEditedValueStandsOverOffAndNewLimits) {
  Car car;
  car.start();
  car.press("j\r\r30\r");
  ASSERT_TRUE(car.rig.off());
  ASSERT_TRUE(car.rig.on());
  car.settle();
  EXPECT_EQ(car.wanted(), 30);
  car.rig.set("maximum", 35.0);
  ASSERT_TRUE(car.rig.reinit());
  car.settle();
  EXPECT_EQ(car.wanted(), 30);
  car.rig.set("maximum", 25.0);
  ASSERT_TRUE(car.rig.reinit());
  car.settle();
  EXPECT_EQ(car.wanted(), 20) << "preset: no longer within the limits";
}

TEST(DisplayManager, NoiseNeverLeavesTheLimits) {
  Car car;
  car.start();
  std::uint32_t random = 1;
  for (int i = 0; i < 2000; ++i) {
    std::string keys;
    for (int k = 0; k < 16; ++k) {
      random = random * 1664525 + 1013904223;
      const auto any = static_cast<char>(1 + (random >> 9 & 126));
      keys += random >> 31 != 0 ? "\r\x1b[ABCDj+-.01234"[random >> 8 & 15] : any;
    }
    car.rig.set("keys", Text<20>(keys));
    car.cycle();
    ASSERT_GE(car.wanted(), 0);
    ASSERT_LE(car.wanted(), 40);
  }
}

TEST(DisplayManager, RefusesMenusThatDoNotFit) {
  const auto said = [](MenuItem item) {
    Car car(true, {item});
    return std::string(car.rig.init().text);
  };
  EXPECT_EQ(said({"a", "knob", 0, 0, 6}), "the kind of a menu item is text, show, edit or go");
  EXPECT_EQ(said({"a", "text", 2, 0, 6}), "a menu item stands on a screen that is not there");
  for (const char* kind : {"show", "edit"})
    for (const std::int32_t number : {-1, 1})
      EXPECT_EQ(said({"a", kind, 0, number, 6}), "a menu item names a value or screen that is not there");
  EXPECT_EQ(said({"a", "go", 0, 2, 6}), "a menu item names a value or screen that is not there");
  EXPECT_EQ(said({"a", "show", 0, 0, 16}), "digits of a menu item are 1 to 15");
  Car car;
  car.rig.set("preset", 41.0);
  EXPECT_EQ(car.rig.init().text, "preset lies between minimum and maximum");
  car.rig.set("preset", 20.0), car.rig.set("step", 0.0);
  EXPECT_EQ(car.rig.init().text, "step is above 0");
  car.rig.set("step", 1.0), car.rig.set("maximum", HUGE_VAL);
  EXPECT_EQ(car.rig.init().text, "minimum and maximum are finite");
}

}  // namespace
}  // namespace chimera
