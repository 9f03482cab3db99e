// SPDX-License-Identifier: Apache-2.0
// The device at the other end is a pseudo terminal: no hardware is needed.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

#include "chimera/task/rig.h"

using namespace chimera;

struct @TYPE@ : ::testing::Test {
  Rig rig{"@NAME@"};
  int device = -1;  // the other end
  int line = -1;    // another descriptor of the component's end

  @TYPE@() { plug(); }
  ~@TYPE@() override { unplug(); }
  void plug() {
    device = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_EQ(::grantpt(device) | ::unlockpt(device), 0);
    rig.resource("device", ::ptsname(device));
    ASSERT_GE(line = ::open(::ptsname(device), O_RDWR | O_NOCTTY), 0);
  }
  void unplug() {
    if (device >= 0) ::close(device);
    if (line >= 0) ::close(line);
    device = line = -1;
  }
  void start() {
    rig.set("speed", 0.0);
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
  }
  // Waits until the bytes have arrived at the component's end, because the kernel delays them.
  void say(const char* text) {
    const int size = static_cast<int>(std::strlen(text));
    int before = 0, there = 0;
    ASSERT_EQ(::ioctl(line, FIONREAD, &before), 0);
    ASSERT_EQ(::write(device, text, std::strlen(text)), size);
    for (int i = 0; i < 60'000 && there < before + size; ++i) {
      if (i > 0) ::usleep(1000);
      ASSERT_EQ(::ioctl(line, FIONREAD, &there), 0);
    }
  }
  // Returns the bytes that the device received: waits for `size` bytes, or 20 ms without a size.
  std::string heard(std::size_t size = 0) {
    std::string all;
    pollfd ready{device, POLLIN, 0};
    while ((size == 0 || all.size() < size) && ::poll(&ready, 1, size == 0 ? 20 : 60'000) > 0) {
      char text[256];
      const ssize_t got = ::read(device, text, size == 0 ? sizeof text : size - all.size());
      if (got <= 0) break;
      all.append(text, static_cast<std::size_t>(got));
    }
    return all;
  }
  double position() { return rig.get<double>("position"); }
};

TEST_F(@TYPE@, SendsSpeedAndReadsPosition) {
  start();
  rig.set("speed", 0.5);
  say("P 1.2");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(position(), 0);  // the line is not complete
  say("5\n");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(position(), 1.25);
  EXPECT_TRUE(rig.get<bool>("connected"));
  EXPECT_EQ(heard(16), "S 0.000\nS 0.500\n");
}

TEST_F(@TYPE@, MovesNoDeviceThatDoesNotAnswer) {
  start();
  rig.set("speed", 1.0);
  for (int restart = 0; restart < 3; ++restart) {
    for (int i = 0; i < 11; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
    EXPECT_FALSE(rig.cycle());
    for (int i = 0; i < 11; ++i) EXPECT_EQ(heard(8), "S 0.000\n");
    ASSERT_TRUE(rig.clear());
    ASSERT_TRUE(rig.on());
  }
}

TEST_F(@TYPE@, HandsOverASafeFrame) {
  start();
  const auto& safe = rig.safe_frame(0);
  EXPECT_GE(safe.descriptor, 0);
  EXPECT_EQ(std::string(safe.bytes, safe.bytes + safe.size), "\nS 0.000\n");
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.safe_frame(0).size, 0u);
  ASSERT_TRUE(rig.kill());
  EXPECT_LT(rig.safe_frame(0).descriptor, 0);
}

TEST_F(@TYPE@, SkipsNoise) {
  start();
  say("\xff\x01 P\nP x\nP nan\nP 2 \nP 3\n");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(position(), 3);
}

TEST_F(@TYPE@, SendsNoNanAndCutsAtLimit) {
  start();
  say("P 1\n");
  rig.set("speed", std::nan(""));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(), "");
  rig.set("speed", -1e9);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(9), "S -1.000\n");
}

TEST_F(@TYPE@, StopsTheDeviceAtOff) {
  start();
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(heard(8), "S 0.000\n");
}

TEST_F(@TYPE@, StopsDeviceWhileFlagIsUpAndReportsIt) {
  start();
  rig.set("speed", 1.0);
  say("P 1\n");
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("idled"));
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("idled"));
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("idled"));
  EXPECT_EQ(heard(24), "S 1.000\nS 0.000\nS 1.000\n");
}

TEST_F(@TYPE@, FaultsForLostDeviceUntilClear) {
  start();
  say("P 1\n");
  ASSERT_TRUE(rig.cycle());
  unplug();
  ASSERT_TRUE(rig.cycle());  // publishes the loss first
  EXPECT_FALSE(rig.get<bool>("connected"));
  EXPECT_EQ(rig.cycle().text, "the device is gone or silent: bring it back, then `clear` and `on`");
  EXPECT_FALSE(rig.clear());
  plug();
  ASSERT_TRUE(rig.clear());
  ASSERT_TRUE(rig.on());
  say("P 2\n");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(position(), 2);
}

TEST_F(@TYPE@, StopsSilentDeviceAndFaults) {
  start();
  rig.set("speed", 1.0);
  ASSERT_TRUE(rig.cycle(milliseconds(101)));
  EXPECT_EQ(heard(8), "S 0.000\n");
  EXPECT_FALSE(rig.cycle());
}

TEST_F(@TYPE@, RefusesAMissingDevice) {
  rig.resource("device", "/dev/ttyUSB99");
  EXPECT_EQ(rig.init().text,
            "/dev/ttyUSB99: No such file or directory: plug the device in, or name another under `resources`");
}
