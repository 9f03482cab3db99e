// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
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

struct SerialFrameTest : ::testing::Test {
  Rig rig{"serial_frame"};
  std::string path;
  int device = -1;  // the other end
  int line = -1;    // another descriptor of the component's end

  SerialFrameTest() { plug(); }
  ~SerialFrameTest() override { unplug(); }

  void plug() {
    device = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_EQ(::grantpt(device) | ::unlockpt(device), 0);
    path = ::ptsname(device);
    ASSERT_GE(line = ::open(path.c_str(), O_RDWR | O_NOCTTY), 0);
  }
  void unplug() {
    if (device >= 0) ::close(device);
    if (line >= 0) ::close(line);
    device = line = -1;
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
  /// Waits until the bytes have arrived at the component's end, because the kernel delays them.
  void say(const Bytes& bytes) {
    int before = 0, there = 0;
    ASSERT_EQ(::ioctl(line, FIONREAD, &before), 0);
    ASSERT_EQ(::write(device, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    for (int i = 0; i < 60'000 && there < before + static_cast<int>(bytes.size()); ++i) {
      if (i > 0) ::usleep(1000);
      ASSERT_EQ(::ioctl(line, FIONREAD, &there), 0);
    }
  }
  static Bytes frame(const std::vector<double>& values) {
    Bytes made(values.size() * 4 + kFrameOverhead);
    for (std::size_t i = 0; i < values.size(); ++i) put_value(made.data() + 2 + 4 * i, Form::kFloat32, values[i], 1);
    close_frame(made.data(), values.size() * 4);
    return made;
  }
  /// Bytes that the device received: waits for `size` bytes, or 20 ms without a size.
  Bytes heard(std::size_t size = 0) {
    Bytes bytes;
    pollfd ready{device, POLLIN, 0};
    while ((size == 0 || bytes.size() < size) && ::poll(&ready, 1, size == 0 ? 20 : 60'000) > 0) {
      std::uint8_t chunk[4096];
      const ssize_t got = ::read(device, chunk, size == 0 ? sizeof chunk : size - bytes.size());
      if (got <= 0) break;
      bytes.insert(bytes.end(), chunk, chunk + got);
    }
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
  EXPECT_EQ(heard(12), frame({1.5, -2}));
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
  EXPECT_EQ(count("noise"), 4 + 11);  // and the bytes after the start of the wrong frame
  EXPECT_EQ(state(1), 2);
  say(frame({std::nan(""), 5}));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(count("wrong"), 2);
  EXPECT_EQ(state(1), 2);  // no value of a frame that is not finite
}

TEST_F(SerialFrameTest, NeverSendsANonFiniteNumberAndClampsToTheLimit) {
  rig.set("limit", 10.0);
  start(1, 1);
  say(frame({0}));
  rig.set("command", std::nan(""));
  ASSERT_TRUE(rig.cycle());
  rig.set("command", std::numeric_limits<double>::infinity());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(), Bytes());
  EXPECT_EQ(count("unsent"), 2);
  rig.set("command", -1e300);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(8), frame({-10}));
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
  const Bytes sent = heard(6);
  ASSERT_EQ(sent.size(), 6u);
  EXPECT_EQ(get_bytes(sent.data() + 2, 2), 123u);
}

TEST_F(SerialFrameTest, IdleIsSentAtOffAndWhileTheFlagIsUp) {
  rig.set("idle", 0.25);
  start(1, 1);
  say(frame({1}));
  rig.set("command", 5.0);
  EXPECT_FALSE(rig.get<bool>("idled"));
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("idled"));
  EXPECT_EQ(heard(8), frame({0.25}));
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("idled"));
  EXPECT_EQ(heard(8), frame({5}));
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(heard(8), frame({0.25}));
}

TEST_F(SerialFrameTest, TheSafeFrameEndsACutFrameBeforeIdle) {
  rig.set("idle", 0.25);
  start(1, 1);
  const auto& safe = rig.safe_frame(0);
  EXPECT_GE(safe.descriptor, 0);
  const Bytes bytes(safe.bytes, safe.bytes + safe.size);
  ASSERT_EQ(bytes.size(), kLongestFrame + 8);
  FrameReader reader;
  reader.reset(4);
  const Bytes cut = frame({7});
  std::size_t size = 3;  // size of the frame being sent
  std::memcpy(reader.room().data(), cut.data(), size);
  std::memcpy(reader.room().data() + size, bytes.data(), bytes.size());
  reader.taken(size + bytes.size());
  std::vector<double> heard_values;
  reader.frames([&](std::span<const std::uint8_t> payload) {
    heard_values.push_back(get_value(payload.data(), Form::kFloat32, 1));
  });
  EXPECT_EQ(heard_values, std::vector<double>{0.25});
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.safe_frame(0).size, 0u);
  ASSERT_TRUE(rig.kill());
  EXPECT_LT(rig.safe_frame(0).descriptor, 0);
}

TEST_F(SerialFrameTest, AFullLineDoesNotBlockAndLosesWholeFramesOnly) {
  rig.set("timeout", 3600.0);
  start(1, 16);
  for (int i = 0; i < 3000; ++i) ASSERT_TRUE(rig.cycle());  // the device does not read
  EXPECT_GT(count("unsent"), 100);
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("idled")) << "the idle frame has found no room";
  rig.illegal(false);
  FrameReader reader;
  reader.reset(64);
  int whole = 0;
  for (int i = 0; i < 300; ++i) {
    const Bytes bytes = heard(68);
    for (std::size_t at = 0; at < bytes.size(); at += 100) {
      const std::size_t n = std::min<std::size_t>(100, bytes.size() - at);
      std::memcpy(reader.room().data(), bytes.data() + at, n);
      reader.taken(n);
      reader.frames([&whole](auto) { ++whole; });
    }
    ASSERT_TRUE(rig.cycle());
  }
  EXPECT_GE(whole, 298);
  EXPECT_EQ(reader.wrong() + reader.noise(), 0);
}

TEST_F(SerialFrameTest, ASilentDeviceGetsTheIdleCommandThenIsAFaultAndComesBack) {
  start(1, 1);
  rig.set("command", 5.0);
  say(frame({1}));
  for (int i = 0; i < 11; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_TRUE(connected());
  EXPECT_EQ(heard(11 * 8).size(), 88u) << "a frame of each cycle";
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_FALSE(connected());
  EXPECT_EQ(state(0), 1.0);
  EXPECT_EQ(heard(8), frame({0}));
  EXPECT_EQ(rig.cycle().text, path + " is silent: bring it back, then `clear` and `on`");
  ASSERT_TRUE(rig.clear());
  ASSERT_TRUE(rig.on());
  say(frame({2}));
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(connected());
  EXPECT_EQ(state(0), 2.0);
}

TEST_F(SerialFrameTest, AMuteDeviceGetsNothingButIdleHoweverOftenItsTaskIsRestarted) {
  rig.set("idle", 0.25);
  start(1, 1);
  rig.set("command", 5.0);
  for (int restart = 0; restart < 5; ++restart) {
    say({1, 2, 3});  // noise is no answer
    for (int i = 0; i < 11; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
    EXPECT_EQ(heard(11 * 8).size(), 88u);
    const Bytes all = heard();
    for (std::size_t at = 0; at < all.size(); at += 8)
      EXPECT_EQ(Bytes(all.begin() + static_cast<std::ptrdiff_t>(at), all.begin() + static_cast<std::ptrdiff_t>(at + 8)),
                frame({0.25}));
    EXPECT_FALSE(rig.cycle());
    ASSERT_TRUE(rig.clear());
    ASSERT_TRUE(rig.on());
  }
  say(frame({1}));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(8), frame({5}));
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
  rig.resource("device", path.c_str());  // a new pseudo terminal may have another name
  ASSERT_TRUE(rig.clear());
  ASSERT_TRUE(rig.on());
  say(frame({2}));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(state(0), 2.0);
}

TEST_F(SerialFrameTest, RefusesWrongConstantsAndOtherDevices) {
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
