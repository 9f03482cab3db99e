// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "chimera/task/rig.h"
#include "library/frame/frame.h"
#include "library/frame/values.h"

namespace chimera {
namespace {

using namespace library;
using Bytes = std::vector<std::uint8_t>;

struct SerialFrameTest : testing::Test {
  Rig rig{"serial_frame"};
  std::string path;
  int device = -1;  // the other end

  SerialFrameTest() { plug(); }
  ~SerialFrameTest() override { unplug(); }

  void plug() {
    device = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_EQ(::grantpt(device) | ::unlockpt(device), 0);
    path = ::ptsname(device);
  }
  void unplug() {
    if (device >= 0) ::close(device);
    device = -1;
  }
  void start(std::int32_t fields = 2, std::uint32_t commands = 2) {
    rig.extent("m", commands);
    rig.set("fields", fields);
    rig.resource("device", path.c_str());
    for (std::uint32_t i = 0; i < commands; ++i) rig.set("command", 0.0, i);
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  void say(const Bytes& bytes) {
    ASSERT_EQ(::write(device, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  static Bytes frame(const std::vector<double>& values) {
    Bytes made(values.size() * 4 + kFrameOverhead);
    for (std::size_t i = 0; i < values.size(); ++i) put_value(made.data() + 2 + 4 * i, Form::kFloat32, values[i], 1);
    close_frame(made.data(), values.size() * 4);
    return made;
  }
  /// All that the device has heard.
  Bytes heard() {
    Bytes bytes(4096);
    pollfd ready{device, POLLIN, 0};
    ::poll(&ready, 1, 0);
    const ssize_t got = ::read(device, bytes.data(), bytes.size());
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }
  double state(std::size_t i) { return rig.get<double>("state", i); }
  std::int64_t count(const char* name) { return rig.get<std::int64_t>(name); }
  bool connected() { return rig.get<bool>("connected"); }
};

TEST_F(SerialFrameTest, ACommandGoesOutAndAStateComesIn) {
  start();
  rig.set("command", 1.5, 0);
  rig.set("command", -2.0, 1);
  EXPECT_FALSE(connected());
  say(frame({3.25, -4}));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(state(0), 3.25);
  EXPECT_EQ(state(1), -4);
  EXPECT_TRUE(connected());
  EXPECT_EQ(heard(), frame({1.5, -2}));
  ASSERT_TRUE(rig.cycle(milliseconds(20)));
  EXPECT_DOUBLE_EQ(rig.get<double>("age"), 0.02);
  EXPECT_EQ(state(0), 3.25);
}

TEST_F(SerialFrameTest, NoiseCutFramesAndWrongChecksumsAreCountedAndPassedOver) {
  start();
  Bytes wrong = frame({7, 7});
  wrong[4] ^= 1;
  say({0, 1, 2, 0xFF});
  say(wrong);
  const Bytes good = frame({1, 2});
  say({good.begin(), good.begin() + 5});
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(count("received"), 0);
  EXPECT_FALSE(connected());
  say({good.begin() + 5, good.end()});
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(count("received"), 1);
  EXPECT_EQ(count("wrong"), 1);
  EXPECT_EQ(count("noise"), 4 + 11);  // and what was behind the start of the wrong one
  EXPECT_EQ(state(1), 2);
  say(frame({std::nan(""), 5}));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(count("wrong"), 2);
  EXPECT_EQ(state(1), 2);  // nothing of a frame that is not finite
}

TEST_F(SerialFrameTest, WhatIsNotFiniteIsNeverSentAndTheRestIsHeldWithinTheLimit) {
  rig.set("limit", 10.0);
  start(1, 1);
  rig.set("command", std::nan(""));
  ASSERT_TRUE(rig.cycle());
  rig.set("command", std::numeric_limits<double>::infinity());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(), Bytes());
  EXPECT_EQ(count("unsent"), 2);
  rig.set("command", -1e300);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(), frame({-10}));
}

TEST_F(SerialFrameTest, WholeNumbersOfAResolution) {
  rig.set("form", Text<8>("int16"));
  rig.set("command_resolution", 0.01);
  rig.set("state_resolution", 0.5);
  start(1, 1);
  rig.set("command", 1.234);
  Bytes answer(2 + kFrameOverhead);
  put_bytes(answer.data() + 2, 0xFFFE, 2);
  close_frame(answer.data(), 2);
  say(answer);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(state(0), -1.0);
  const Bytes sent = heard();
  ASSERT_EQ(sent.size(), 6u);
  EXPECT_EQ(get_bytes(sent.data() + 2, 2), 123u);
}

TEST_F(SerialFrameTest, IdleIsSentAtOffAndWhileTheFlagIsUp) {
  rig.set("idle", 0.25);
  start(1, 1);
  rig.set("command", 5.0);
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(), frame({0.25}));
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(), frame({5}));
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(heard(), frame({0.25}));
}

TEST_F(SerialFrameTest, ALineThatIsFullWaitsForNobodyAndLosesNoFrameInTheMiddle) {
  rig.set("timeout", 3600.0);
  start(1, 16);
  for (int i = 0; i < 3000; ++i) ASSERT_TRUE(rig.cycle());  // nobody reads
  EXPECT_GT(count("unsent"), 100);
  FrameReader reader;
  reader.reset(64);
  int whole = 0;
  for (int i = 0; i < 3000; ++i) {
    const Bytes bytes = heard();
    for (std::size_t at = 0; at < bytes.size(); at += 100) {
      const std::size_t n = std::min<std::size_t>(100, bytes.size() - at);
      std::memcpy(reader.room().data(), bytes.data() + at, n);
      reader.taken(n);
      reader.frames([&whole](auto) { ++whole; });
    }
    if (bytes.empty() && !rig.cycle()) FAIL();
    if (whole > 1000) break;
  }
  EXPECT_GT(whole, 1000);
  EXPECT_EQ(reader.wrong() + reader.noise(), 0);
}

TEST_F(SerialFrameTest, ASilentDeviceGetsTheIdleCommandThenIsAFaultAndComesBack) {
  start(1, 1);
  rig.set("command", 5.0);
  say(frame({1}));
  for (int i = 0; i < 11; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_TRUE(connected());
  heard();
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_FALSE(connected());
  EXPECT_EQ(state(0), 1.0);
  EXPECT_EQ(heard(), frame({0}));
  EXPECT_EQ(rig.cycle().text, path + " is silent: bring it back, then `clear` and `on`");
  ASSERT_TRUE(rig.clear());
  ASSERT_TRUE(rig.on());
  say(frame({2}));
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(connected());
  EXPECT_EQ(state(0), 2.0);
}

TEST_F(SerialFrameTest, ADeviceThatIsUnpluggedIsAFaultAndComesBackByClear) {
  start(1, 1);
  say(frame({1}));
  ASSERT_TRUE(rig.cycle());
  unplug();
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(connected());
  EXPECT_EQ(state(0), 1.0);
  EXPECT_EQ(rig.cycle().text, path + " is gone: bring it back, then `clear` and `on`");
  EXPECT_EQ(rig.clear().status, CHIMERA_FAULT);
  plug();
  rig.resource("device", path.c_str());  // a pseudo terminal may come back under another name
  ASSERT_TRUE(rig.clear());
  ASSERT_TRUE(rig.on());
  say(frame({2}));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(state(0), 2.0);
}

TEST_F(SerialFrameTest, RefusesWrongConstantsAndWhatIsNoSerialDevice) {
  const auto answer = [this](const char* name) {
    rig.resource("device", name);
    return rig.init().text;
  };
  rig.extent("m", 1);
  EXPECT_EQ(answer("/dev/null"), "/dev/null: no serial device: those are /dev/ttyS*, /dev/ttyUSB*, /dev/ttyACM*");
  EXPECT_EQ(answer("/dev/ttyUSB99"),
            "/dev/ttyUSB99: No such file or directory: plug the device in, or name another under `resources`");
  rig.set("baud", std::int32_t{12345});
  EXPECT_EQ(answer(path.c_str()),
            "`baud` is one of 9600 19200 38400 57600 115200 230400 460800 921600 1000000 2000000");
  rig.set("form", Text<8>("double"));
  EXPECT_EQ(answer(path.c_str()), "`form` is float32 or int16");
  rig.set("form", Text<8>("int16"));
  rig.set("idle", 2.0);
  rig.set("limit", 1.0);
  EXPECT_EQ(answer(path.c_str()), "`idle` is within +- `limit`");
  rig.set("command_resolution", 0.0);
  EXPECT_EQ(answer(path.c_str()), "a resolution is finite and not 0");
}

}  // namespace
}  // namespace chimera
