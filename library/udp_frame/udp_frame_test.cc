// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "chimera/task/rig.h"
#include "library/frame/frame.h"
#include "library/frame/values.h"

namespace chimera {
namespace {

using namespace library;
using Bytes = std::vector<std::uint8_t>;

struct UdpFrameTest : ::testing::Test {
  Rig rig{"udp_frame"};
  int device = -1;  // the other end
  std::string address;
  sockaddr_in task{};  // source address of the component's datagrams

  UdpFrameTest() { plug(0); }
  ~UdpFrameTest() override { ::close(device); }

  void plug(std::uint16_t port) {
    device = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    here.sin_port = htons(port);
    ASSERT_EQ(::bind(device, reinterpret_cast<sockaddr*>(&here), sizeof here), 0);
    socklen_t size = sizeof here;
    ASSERT_EQ(::getsockname(device, reinterpret_cast<sockaddr*>(&here), &size), 0);
    address = "127.0.0.1:" + std::to_string(ntohs(here.sin_port));
  }
  void start() {
    rig.extent("m", 1);
    rig.set("command", 0.0);
    rig.resource("device", address.c_str());
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
    ASSERT_TRUE(rig.cycle());
    EXPECT_EQ(heard(), datagram(1, 0));  // which also shows the return address
  }
  static Bytes datagram(std::uint32_t number, double value) {
    Bytes made(8 + kFrameOverhead);
    put_bytes(made.data() + 2, number, 4);
    put_value(made.data() + 6, Form::kFloat32, value, 1);
    close_frame(made.data(), 8);
    return made;
  }
  void say(const Bytes& bytes) {
    ASSERT_EQ(::sendto(device, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&task), sizeof task),
              static_cast<ssize_t>(bytes.size()));
  }
  Bytes heard() {
    Bytes bytes(512);
    socklen_t size = sizeof task;
    const ssize_t got = ::recvfrom(device, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&task), &size);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }
  std::int64_t count(const char* name) { return rig.get<std::int64_t>(name); }
  double state() { return rig.get<double>("state"); }
};

TEST_F(UdpFrameTest, ACommandGoesOutAndAStateComesIn) {
  start();
  rig.set("command", 2.5);
  say(datagram(10, -1.5));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(), datagram(2, 2.5));
  EXPECT_EQ(state(), -1.5);
  EXPECT_TRUE(rig.get<bool>("connected"));
}

TEST_F(UdpFrameTest, SaysThatIdleHasGoneOutSinceTheFlagIsUp) {
  start();
  rig.set("command", 2.5);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("idled"));
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(rig.get<bool>("idled"));
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("idled"));
}

TEST_F(UdpFrameTest, TheSafeFrameHasANumberThatADeviceStillTakes) {
  start();
  rig.set("command", 2.5);
  const auto& safe = rig.safe_frame(0);
  EXPECT_GE(safe.descriptor, 0);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(rig.cycle());
  const Bytes bytes(safe.bytes, safe.bytes + safe.size);
  const std::uint32_t number = get_bytes(bytes.data() + 2, 4);
  EXPECT_EQ(bytes, datagram(number, 0));
  EXPECT_EQ(number, 1u << 30);
  say(datagram(3, 1));
  say(bytes);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(count("old"), 0);
  EXPECT_EQ(count("received"), 2) << "this side acts as the device and drops old datagrams";
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(rig.safe_frame(0).size, 0u);
}

TEST_F(UdpFrameTest, ACycleTakesEightDatagramsAtMost) {
  start();
  for (std::uint32_t i = 1; i <= 12; ++i) say(datagram(i, i));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(state(), 8);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(state(), 12);
}

TEST_F(UdpFrameTest, DatagramsFromBeforeOnAreDroppedAndAreNoSilence) {
  start();
  ASSERT_TRUE(rig.off());
  for (std::uint32_t i = 1; i <= 150; ++i) say(datagram(i, 99));
  ASSERT_TRUE(rig.on());
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(rig.cycle(milliseconds(70)));
    EXPECT_EQ(count("received"), 0);
  }
  ASSERT_TRUE(rig.cycle(milliseconds(70))) << "0.21 s since on, of a timeout of 0.1 s";
  EXPECT_EQ(count("received"), 0);
  say(datagram(151, 5));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(state(), 5);
}

TEST_F(UdpFrameTest, AFloodIsForgottenNoLongerThanAQueueIs) {
  start();
  ASSERT_TRUE(rig.off());
  std::uint32_t number = 0;
  while (number < 70) say(datagram(++number, 5));
  ASSERT_TRUE(rig.on());
  for (int cycles = 0; cycles < 20 && count("received") == 0; ++cycles) {
    for (int i = 0; i < 70; ++i) say(datagram(++number, 5));
    ASSERT_TRUE(rig.cycle());
  }
  EXPECT_GT(count("received"), 0);
}

TEST_F(UdpFrameTest, NeverSendsANonFiniteNumber) {
  start();
  say(datagram(1, 0));
  rig.set("command", std::nan(""));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(heard(), Bytes());
  EXPECT_EQ(count("unsent"), 1);
}

TEST_F(UdpFrameTest, ADeviceThatGoesIsAFaultAndComesBackByClear) {
  start();
  rig.set("command", 5.0);
  say(datagram(1, 1));
  ASSERT_TRUE(rig.cycle());
  heard();
  ::close(device);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_TRUE(rig.get<bool>("connected"));
  ASSERT_TRUE(rig.cycle(milliseconds(10)));
  EXPECT_FALSE(rig.get<bool>("connected"));
  EXPECT_EQ(state(), 1);
  const RigAnswer fault = rig.cycle();
  EXPECT_EQ(fault.text, address + " is silent: bring it back, then `clear` and `on`");
  EXPECT_EQ(fault.code, ECONNREFUSED);
  plug(static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':') + 1))));
  ASSERT_TRUE(rig.clear());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(get_value(heard().data() + 6, Form::kFloat32, 1), 0.0) << "no answer yet";
  say(datagram(1, 2));  // the device has restarted its numbers
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(state(), 2);
  EXPECT_EQ(get_value(heard().data() + 6, Form::kFloat32, 1), 5.0);
}

TEST_F(UdpFrameTest, AMuteDeviceGetsNothingButIdleHoweverOftenItsTaskIsRestarted) {
  rig.set("idle", 0.25);
  rig.extent("m", 1);
  rig.set("command", 5.0);
  rig.resource("device", address.c_str());
  ASSERT_TRUE(rig.init());
  std::uint32_t number = 0;
  for (int restart = 0; restart < 5; ++restart) {
    ASSERT_TRUE(rig.on());
    for (int i = 0; i < 11; ++i) {
      ASSERT_TRUE(rig.cycle(milliseconds(10)));
      EXPECT_EQ(heard(), datagram(++number, 0.25));
      say({1, 2, 3});  // a refused datagram is no answer
    }
    EXPECT_FALSE(rig.cycle());
    ASSERT_TRUE(rig.clear());
  }
}

/// Outputs that follow from a sequence of datagrams by the data sheet.
struct Expected {
  bool has_number = false;
  std::uint32_t number = 0;
  std::int64_t received = 0, wrong = 0, missing = 0, old = 0;
  double state = 0;
  int quiet = 0;  // cycles of 1 ms since the last good datagram, or since on
  bool connected = false;

  void hear(std::uint32_t n, double value) {
    const auto step = static_cast<std::int32_t>(n - number);
    if (has_number && step <= 0) ++old;
    else if (!std::isfinite(value)) ++wrong;
    else {
      if (has_number) missing += step - 1;
      has_number = connected = true, number = n, state = value, quiet = 0;
      ++received;
    }
  }
};

/// A device that numbers its datagrams across the wrap, swaps, repeats, loses and damages them, and starts anew.
struct BadNetwork : UdpFrameTest {
  std::mt19937 source{19};
  Expected expected;
  std::uint32_t number = 0xFFFFFFE0;
  double value = 0;

  std::uint32_t random() { return static_cast<std::uint32_t>(source()); }
  void good(std::uint32_t n, double x) {
    say(datagram(n, x));
    expected.hear(n, x);
  }
  void refused() {
    Bytes bytes = datagram(number + 1, 99);
    switch (random() % 4) {
      case 0: bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << random() % 8); break;
      case 1: bytes.resize(random() % bytes.size()); break;
      case 2: bytes.resize(bytes.size() + 1 + random() % 80); break;
      default: bytes = Bytes(random() % 70, 0xA5);
    }
    say(bytes);
    ++expected.wrong;
  }
  void strange() {
    const int stranger = ::socket(AF_INET, SOCK_DGRAM, 0);
    const Bytes bytes = datagram(number + 1, 99);
    ::sendto(stranger, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&task), sizeof task);
    ::close(stranger);
  }
  void happen() {
    switch (random() % 12) {
      case 0: return good(number += 1 + random() % 5, ++value);
      case 1: return good(number + 2, value += 2), good(number + 1, value - 1), void(number += 2);
      case 2: return good(++number, ++value), good(number, value);
      case 3: return good(number - random() % 1000, 99);
      case 4: return good(number + 1 + random() % 1000, random() % 2 == 0 ? std::nan("") : HUGE_VAL);
      case 5: return refused();
      case 6: return strange();
      case 7: number = random() % 400 == 0 ? random() : number; break;
      default: break;
    }
    good(++number, ++value);
  }
};

TEST_F(BadNetwork, ARefusedDatagramChangesNothingButItsCount) {
  start();
  expected.quiet = 2;
  int restarts = 0;
  for (int i = 0; i < 60'000; ++i) {
    for (std::uint32_t n = random() % 4; n > 0; --n) happen();
    ASSERT_TRUE(rig.cycle());
    const bool is_lost = ++expected.quiet > 101;  // a good datagram of this cycle made it 1
    if (is_lost) expected.connected = false;
    ASSERT_EQ(state(), expected.state) << i;
    ASSERT_EQ(count("received"), expected.received) << i;
    ASSERT_EQ(count("wrong"), expected.wrong) << i;
    ASSERT_EQ(count("missing"), expected.missing) << i;
    ASSERT_EQ(count("old"), expected.old) << i;
    ASSERT_NEAR(rig.get<double>("age"), (expected.quiet - 1) * 1e-3, 1e-9) << i;
    ASSERT_EQ(rig.get<bool>("connected"), expected.connected) << i;
    heard();
    if (i == 30) {
      ASSERT_LT(number, 0xFFFFu) << "the number did not wrap";
    }
    if (!is_lost) continue;
    EXPECT_EQ(rig.cycle().text, address + " sends no good frame: bring it back, then `clear` and `on`");
    ASSERT_TRUE(rig.clear() && rig.on());
    expected.has_number = false, expected.quiet = 1;
    ++restarts;
  }
  EXPECT_GT(restarts, 0);
}

TEST_F(UdpFrameTest, NeitherAnEmptyDatagramNorAnErrorHidesThoseFromBeforeOn) {
  start();
  ::close(device);
  ASSERT_TRUE(rig.off());  // the network answers that the port is closed
  plug(static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':') + 1))));
  say(datagram(7, 99));
  say({});
  say(datagram(8, 99));
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(count("received"), 0);
  EXPECT_EQ(state(), 0);
}

TEST_F(UdpFrameTest, ItsPortIsNotLostToTheCopyThatTheGuardHas) {
  const int found = ::socket(AF_INET, SOCK_DGRAM, 0);  // finds a free port
  sockaddr_in here{};
  here.sin_family = AF_INET;
  socklen_t size = sizeof here;
  ASSERT_EQ(::bind(found, reinterpret_cast<sockaddr*>(&here), size), 0);
  ASSERT_EQ(::getsockname(found, reinterpret_cast<sockaddr*>(&here), &size), 0);
  ::close(found);
  rig.set("local_port", std::int32_t{ntohs(here.sin_port)});
  start();
  const int copy = ::dup(rig.safe_frame(0).descriptor);
  ASSERT_GE(copy, 0);
  for (int i = 0; i < 12; ++i) rig.cycle(milliseconds(10));
  const RigAnswer cleared = rig.clear();
  EXPECT_TRUE(cleared) << cleared.text;
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_GE(rig.safe_frame(0).descriptor, 0);
  ::close(copy);
}

TEST_F(UdpFrameTest, SendsIdleAtOff) {
  start();
  rig.set("command", 5.0);
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(heard(), datagram(2, 0));
}

TEST_F(UdpFrameTest, RefusesABadAddressAndATakenPort) {
  rig.extent("m", 1);
  for (const std::string text : {"", "localhost:5000", "1.2.3.4", "1.2.3.4:", "1.2.3.4:0", "1.2.3.4:65536",
                                 "1.2.3.4:5x"}) {
    rig.resource("device", text.c_str());
    EXPECT_EQ(rig.init().text, "\"" + text + "\" is no address: \"192.168.0.7:5000\" is one");
  }
  const std::string port = address.substr(address.find(':') + 1);
  rig.resource("device", address.c_str());
  rig.set("local_port", std::int32_t{std::stoi(port)});
  EXPECT_EQ(rig.init().text,
            "UDP port " + port + ": Address already in use: name another `local_port`, or end the process that has it");
}

}  // namespace
}  // namespace chimera
