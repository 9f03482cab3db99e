// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

/// A button on a pin that is a file.
struct ButtonTest : ::testing::Test {
  ButtonTest() {
    write("0\n");
    rig.resource("pin", path.c_str());
    rig.set("target", Text<64>("lamp"));
  }
  ~ButtonTest() override { std::filesystem::remove(path); }
  void write(const std::string& text) const { std::ofstream(path, std::ios::trunc) << text; }
  /// A cycle of 10 ms for each letter, with the pin at that level; answers `pressed` of each cycle.
  std::string run(const std::string& levels) {
    std::string text;
    for (const char level : levels) {
      write({level, '\n'});
      EXPECT_TRUE(rig.cycle(milliseconds(10)));
      text += rig.get<bool>("pressed") ? '1' : '0';
    }
    return text;
  }

  const std::string path = testing::TempDir() + "button_" + std::to_string(::getpid());
  Rig rig{"button"};
};

TEST_F(ButtonTest, SendsASignalForEachPressThatLasts) {
  rig.set("debounce", 0.02);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(run("0101111001000011110"), "0000011111110000111");
  EXPECT_EQ(rig.signals(), (std::vector<std::string>{"wakeup lamp", "wakeup lamp"}));
  EXPECT_EQ(rig.get<std::int64_t>("presses"), 2);
}

TEST_F(ButtonTest, SendsOtherSignalsAndKnowsPinsThatAreLowWhenPressed) {
  rig.set("debounce", 0.0), rig.set("active_low", true);
  rig.set("press", Text<16>("on")), rig.set("release", Text<16>("off"));
  write("1");
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(run("1001"), "0110");
  EXPECT_EQ(rig.signals(), (std::vector<std::string>{"on lamp", "off lamp"}));
}

TEST_F(ButtonTest, APressWhileOffSendsNothing) {
  rig.set("debounce", 0.0);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(run("01"), "01");
  ASSERT_TRUE(rig.off());
  EXPECT_FALSE(rig.get<bool>("pressed"));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(run("11"), "11");
  EXPECT_EQ(rig.signals().size(), 1u);
}

TEST_F(ButtonTest, WithoutTargetOnlyPublishes) {
  rig.set("target", Text<64>("")), rig.set("debounce", 0.0);
  ASSERT_TRUE(rig.init() && rig.on());
  EXPECT_EQ(run("01"), "01");
  EXPECT_TRUE(rig.signals().empty());
}

TEST_F(ButtonTest, RefusesPinsAndConstantsThatCannotBe) {
  rig.set("press", Text<16>("go"));
  EXPECT_EQ(rig.init().text, "press is no signal");
  rig.set("press", Text<16>("")), rig.set("release", Text<16>("go"));
  EXPECT_EQ(rig.init().text, "release is no signal");
  rig.set("release", Text<16>("")), rig.set("debounce", std::nan(""));
  EXPECT_EQ(rig.init().text, "debounce is 0 to 10 s");
  rig.set("debounce", 0.0);
  write("up");
  EXPECT_EQ(rig.init().text, path + " does not begin with 0 or 1");
  rig.resource("pin", "/nowhere");
  EXPECT_EQ(rig.init().text, "/nowhere cannot be opened: No such file or directory");
}

TEST_F(ButtonTest, APinThatCannotBeReadIsAFault) {
  ASSERT_TRUE(rig.init() && rig.on());
  write("");
  EXPECT_EQ(rig.cycle().text, "the pin cannot be read");
}

}  // namespace
}  // namespace chimera
