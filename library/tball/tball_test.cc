// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

#include "chimera/base/testing/tree_path.h"
#include "chimera/task/geometry.h"
#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct TballTest : ::testing::Test {
  Rig rig{"tball"};
  std::string path = testing::TempDir() + "tball_" + std::to_string(::getpid());
  int pipe = -1;

  TballTest() { rig.instances("xm", 0); }
  ~TballTest() override {
    if (pipe >= 0) ::close(pipe);
    ::unlink(path.c_str());
  }
  static std::string shipped() {
    return source_path("library/tball/wave.events");
  }
  void recording(const std::string& text) { std::ofstream(path) << text; }
  RigAnswer init(const std::string& device) {
    rig.resource("device", device.c_str());
    return rig.init();
  }
  void start(const std::string& device) {
    const RigAnswer made = init(device);
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  void plug() { ASSERT_GE(pipe = ::open(path.c_str(), O_RDWR | O_NONBLOCK), 0); }
  void unplug() {
    ::close(pipe);
    pipe = -1;
  }
  void event(std::uint16_t type, std::uint16_t code, std::int32_t value) {
    input_event e{};
    e.type = type;
    e.code = code;
    e.value = value;
    ASSERT_EQ(::write(pipe, &e, sizeof e), static_cast<ssize_t>(sizeof e));
  }
  void report() { event(EV_SYN, SYN_REPORT, 0); }
  double motion(std::size_t i) { return rig.get<double>("motion", i); }
  Pose xd() { return rig.get<Pose>("xd"); }
};

TEST_F(TballTest, ARecordingPlaysOnTheClockOfTheTask) {
  recording("# ours\nE: 7.000000 0002 0000 175\nE: 7.000000 0000 0000 0\n"
            "E: 7.100000 0002 0001 -999\nE: 7.100000 0000 0000 0\n");
  rig.set("scale", 2.0, 0);
  start(path);
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_EQ(motion(0), 1.0);  // half of the full 350, times 2
  EXPECT_EQ(motion(1), 0.0);
  for (int i = 0; i < 9; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_EQ(motion(1), -1.0);  // more than full deflection: cut
  for (int i = 0; i < 22; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_EQ(motion(0), 0.0);  // silent for 0.2 s: released
  EXPECT_EQ(motion(1), 0.0);
}

TEST_F(TballTest, TheShippedRecordingGoesOutAndComesBack) {
  start(shipped());
  double far = 0, turned = 0;
  int pressed = 0;
  for (int i = 0; i < 450; ++i) {
    ASSERT_TRUE(rig.cycle(milliseconds(10)));
    far = std::fmax(far, xd().position[0]);
    turned = std::fmax(turned, 2 * std::acos(xd().orientation[0]));
    pressed += rig.get<std::int32_t>("buttons");
  }
  EXPECT_NEAR(far, 2 * 0.1 * 2 / M_PI, 0.002);           // a half sine of 2 s at 0.1 m/s
  EXPECT_NEAR(turned, 2 * 0.5 / M_PI, 0.02);              // a half sine of 1 s at 0.5 rad/s
  EXPECT_NEAR(xd().position[0], 0, 0.005);
  EXPECT_EQ(pressed, 20);
}

TEST_F(TballTest, TwoRunsOfARecordingAgreeToTheBit) {
  start(shipped());
  Rig other("tball");
  other.instances("xm", 0);
  other.resource("device", shipped().c_str());
  ASSERT_TRUE(other.init());
  ASSERT_TRUE(other.on());
  for (int i = 0; i < 400; ++i) {
    ASSERT_TRUE(rig.cycle(milliseconds(10)));
    ASSERT_TRUE(other.cycle(milliseconds(10)));
    const Pose a = xd(), b = other.get<Pose>("xd");
    ASSERT_EQ(std::memcmp(&a, &b, sizeof a), 0) << i;
  }
}

TEST_F(TballTest, StartsAtTheHandedOverReference) {
  rig.instances("xm", 1);
  rig.set("xm", Pose{{1, 2, 3}, {1, 0, 0, 0}});
  rig.set("xd", Pose{{1, 2, 4}, {1, 0, 0, 0}});
  rig.inherit("xd", milliseconds(20), milliseconds(10));
  start(shipped());
  EXPECT_EQ(rig.get<Pose>("xd").position[2], 4);
  rig.inherit("xd", milliseconds(21), milliseconds(10));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<Pose>("xd").position[2], 3) << "where the tool is";
}

TEST_F(TballTest, StartsWhereTheToolIsAndTurnsAboutTheAxesOfTheFrame) {
  recording("E: 0.000000 0003 0005 350\nE: 0.000000 0000 0000 0\n");
  rig.instances("xm", 1);
  rig.set("xm", Pose{{1, 2, 3}, {1, 0, 0, 0}});
  rig.set("angular", 1.0);
  start(path);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_EQ(xd().position[1], 2.0);
  EXPECT_NEAR(xd().orientation[0], std::cos(0.5), 1e-12);  // 1 s at 1 rad/s: an absolute axis holds
  EXPECT_NEAR(xd().orientation[3], std::sin(0.5), 1e-12);
  rig.set("xm", Pose{{std::nan(""), 0, 0}, {1, 0, 0, 0}});
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.on().text, "xm is not finite or no orientation: xd cannot start there");
}

TEST_F(TballTest, WholeReportsOfADeviceCountAndLostOnesDoNot) {
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  plug();
  start(path);
  event(EV_REL, REL_Z, 350);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(2), 0.0);
  report();
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(2), 1.0);
  event(EV_SYN, SYN_DROPPED, 0);
  event(EV_REL, REL_Z, 350);
  report();
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(2), 0.0);
  event(EV_KEY, BTN_1, 1);
  event(EV_REL, REL_Z, -350);
  report();
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(2), -1.0);
  EXPECT_EQ(rig.get<std::int32_t>("buttons"), 2);
}

TEST_F(TballTest, EventsFromBeforeOnAreDroppedInTheFirstCycles) {
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  plug();
  const RigAnswer made = init(path);
  ASSERT_TRUE(made) << made.text;
  for (int i = 0; i < 100; ++i) event(EV_REL, REL_Z, 350), report();
  ASSERT_TRUE(rig.on());
  for (int i = 0; i < 3; ++i) {  // 64 events in on and in each cycle
    ASSERT_TRUE(rig.cycle());
    EXPECT_EQ(motion(2), 0.0) << i;
  }
  event(EV_REL, REL_Z, 350);
  report();
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(2), 1.0);
}

TEST_F(TballTest, AnEventThatComesInTwoPiecesIsWhole) {
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  plug();
  start(path);
  input_event e[2]{};
  e[0].type = EV_REL;
  e[0].value = 350;
  const auto* bytes = reinterpret_cast<const char*>(e);
  ASSERT_EQ(::write(pipe, bytes, 30), 30);
  ASSERT_TRUE(rig.cycle());
  ASSERT_EQ(::write(pipe, bytes + 30, sizeof e - 30), static_cast<ssize_t>(sizeof e - 30));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), 1.0);
}

TEST_F(TballTest, ALostDeviceRestsThenIsAFaultAndComesBackByClear) {
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  plug();
  start(path);
  event(EV_ABS, ABS_X, 350);
  report();
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), 1.0);
  unplug();
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), 0.0);  // the value that all readers see
  const RigAnswer fault = rig.cycle();
  EXPECT_EQ(fault.status, CHIMERA_FAULT);
  EXPECT_NE(fault.text.find(" is gone: bring it back, then `clear` and `on`"), std::string::npos) << fault.text;
  EXPECT_EQ(rig.clear().text, path + ": opens, but no process has the other end open");
  plug();
  ASSERT_TRUE(rig.clear());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), 0.0);
  event(EV_ABS, ABS_X, -350);
  report();
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), -1.0);
}

TEST_F(TballTest, KeysOfATerminalMoveItUntilItHangsUp) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_EQ(::grantpt(master) | ::unlockpt(master), 0);
  const std::string name = ::ptsname(master);
  const int line = ::open(name.c_str(), O_RDWR | O_NOCTTY);
  const auto press = [&](const char* keys) {
    const int wanted = static_cast<int>(std::strlen(keys));
    ASSERT_EQ(::write(master, keys, std::strlen(keys)), wanted);
    int there = 0;
    for (int i = 0; i < 60'000 && there < wanted; ++i) {  // the kernel delays the bytes
      if (i > 0) ::usleep(1000);
      ASSERT_EQ(::ioctl(line, FIONREAD, &there), 0);
    }
  };
  start(name);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), 0.0);
  press("dQf");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), 1.0);
  EXPECT_EQ(motion(2), -1.0);
  press(" ");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), 0.0);
  ::close(master);
  ::close(line);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.cycle().status, CHIMERA_FAULT);
  EXPECT_EQ(rig.clear().status, CHIMERA_FAULT);
}

TEST_F(TballTest, HoldsStillWhileTheFlagIsUp) {
  recording("E: 0.000000 0003 0000 350\nE: 0.000000 0000 0000 0\n");
  start(path);
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(motion(0), 0.0);
  EXPECT_EQ(xd().position[0], 0.0);
}

TEST_F(TballTest, RefusesADeviceThatIsNoBall) {
  EXPECT_EQ(init("/dev/input/event99").text,
            "/dev/input/event99: No such file or directory: plug the device in, or name another under `resources`");
  EXPECT_EQ(init("/dev/null").text,
            "/dev/null: no input device: those are /dev/input/event*, a terminal is one of keys");
  EXPECT_EQ(init("/tmp").text, "/tmp: neither an input device nor a terminal, a FIFO or a recording");
  recording("E: 0.000000 0002 0000 1\nE: 0.100000 0002 0000\n");
  EXPECT_EQ(init(path).text, path + ":2: no event: \"E: 0.008000 0002 0000 0120\" is one");
  recording("E: 0.200000 0002 0000 1\nE: 0.100000 0002 0000 1\n");
  EXPECT_EQ(init(path).text, path + ":2: the time goes back");
  recording("# nothing\n");
  EXPECT_EQ(init(path).text, path + ": there is no event in it");
}

}  // namespace
}  // namespace chimera
