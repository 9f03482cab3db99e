// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <string>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

/// The component on a pseudo terminal. `window` is the end of a person, `line` another descriptor of the task's end.
struct TerminalTest : ::testing::Test {
  Rig rig{"terminal"};
  int window = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  int line = -1;

  TerminalTest() {
    EXPECT_EQ(::grantpt(window) | ::unlockpt(window), 0);
    EXPECT_GE(line = ::open(::ptsname(window), O_RDWR | O_NOCTTY), 0);
    rig.resource("device", ::ptsname(window));
  }
  ~TerminalTest() override {
    if (window >= 0) ::close(window);
    ::close(line);
  }
  void start() {
    const RigAnswer made = rig.init();
    ASSERT_TRUE(made) << made.text;
    ASSERT_TRUE(rig.on());
    ASSERT_TRUE(rig.cycle());
    ASSERT_EQ(keys(), "\f") << "the whole picture";
  }
  std::string keys() { return rig.get<Text<20>>("keys").c_str(); }
  void show(std::string_view bytes) { rig.set("output", Text<68>(bytes)); }
  /// Waits until the bytes have arrived at the other end, because the kernel delays them.
  void press(const std::string& bytes) const {
    int there = 0;
    ASSERT_EQ(::write(window, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    for (int i = 0; i < 60'000 && there < static_cast<int>(bytes.size()); ++i) {
      if (i > 0) ::usleep(1000);
      ASSERT_EQ(::ioctl(line, FIONREAD, &there), 0);
    }
  }
  std::string seen(std::size_t size) const {
    std::string bytes(size, '\0');
    std::size_t n = 0;
    for (pollfd ready{window, POLLIN, 0}; n < size && ::poll(&ready, 1, 60'000) > 0;) {
      const ssize_t got = ::read(window, bytes.data() + n, size - n);
      if (got <= 0) break;
      n += static_cast<std::size_t>(got);
    }
    bytes.resize(n);
    return bytes;
  }
  tcflag_t local_mode() const {
    termios mode{};
    EXPECT_EQ(::tcgetattr(line, &mode), 0);
    return mode.c_lflag & (ECHO | ICANON);
  }
};

TEST_F(TerminalTest, KeysComeInAndBytesGoOut) {
  start();
  press("\x1b[Bq");
  show("speed");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(keys(), "\x1b[Bq");
  EXPECT_EQ(seen(5), "speed");
  show("");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(keys(), "");
  press("0123456789abcdefg");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(keys(), "0123456789abcdef");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(keys(), "g");
}

TEST_F(TerminalTest, APictureThatLostBytesComesAgain) {
  start();
  std::int64_t written = 0;
  while (rig.get<std::int64_t>("lost") == 0) {
    show(std::string(64, 'x'));
    ASSERT_TRUE(rig.cycle());
    ASSERT_EQ(keys(), "");
    ASSERT_LT(++written, 10'000) << "the line never fills";
  }
  show("");
  std::string all;
  while (keys().empty() && all.size() < 1'000'000) {
    all += seen(1);
    ASSERT_TRUE(rig.cycle());
  }
  EXPECT_EQ(keys(), "\f");
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(keys(), "");
}

TEST_F(TerminalTest, TheLineHasItsOldModeAtTheEnd) {
  const tcflag_t before = local_mode();
  ASSERT_NE(before, 0u);
  start();
  EXPECT_EQ(local_mode(), 0u);
  ASSERT_TRUE(rig.kill());
  EXPECT_EQ(local_mode(), before);
}

TEST_F(TerminalTest, AWindowThatIsClosedIsAFaultUntilClear) {
  start();
  ::close(window);
  window = -1;
  const RigAnswer gone = rig.cycle();
  EXPECT_FALSE(gone);
  EXPECT_NE(gone.text.find("is gone: bring it back, then `clear` and `on`"), std::string::npos) << gone.text;
  EXPECT_FALSE(rig.clear());
}

}  // namespace
}  // namespace chimera
