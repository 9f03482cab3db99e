// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/memory_holder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <fstream>
#include <string>

#include "chimera/platform/owned_descriptor.h"
#include "chimera/platform/process.h"

namespace chimera {
namespace {

constexpr int kPatienceMs = 20'000;

void pause_ms(long ms) {
  const timespec time{ms / 1000, ms % 1000 * 1'000'000};
  ::nanosleep(&time, nullptr);
}

// A process of its own with a memory holder; killed at the end of the test at the latest.
class Deceased : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::pipe2(ends_, O_CLOEXEC), 0);
    pid_ = ::fork();
    ASSERT_GE(pid_, 0);
    if (pid_ == 0) live();
    ::close(ends_[1]);
    char granted = 'n';
    ASSERT_EQ(::read(ends_[0], &granted, 1), 1);
    ASSERT_EQ(granted, 'y');
    std::ifstream children("/proc/" + std::to_string(pid_) + "/task/" + std::to_string(pid_) + "/children");
    if (!(children >> memory_holder_)) GTEST_SKIP() << "this kernel lists no children of a thread";
    pidfd_ = OwnedDescriptor(static_cast<int>(::syscall(SYS_pidfd_open, memory_holder_, 0)));
    ASSERT_GE(pidfd_.fd, 0);
  }
  void TearDown() override {
    if (pid_ > 0) kill_it();
    ::close(ends_[0]);
  }

  [[noreturn]] void live() {
    follow_parent(::getppid(), SIGKILL);  // a test that breaks off leaves nobody behind
    const char granted = start_memory_holder() ? 'y' : 'n';
    if (::write(ends_[1], &granted, 1) != 1) ::_exit(1);
    while (true) ::pause();
  }
  void kill_it() {
    ::kill(pid_, SIGKILL);  // still ours: not reaped yet
    EXPECT_EQ(::waitpid(pid_, nullptr, 0), pid_);
    pid_ = -1;
  }
  bool has_memory_holder_ended(int limit_ms) const {
    pollfd ended{pidfd_.fd, POLLIN, 0};
    return ::poll(&ended, 1, limit_ms) == 1;
  }

  int ends_[2] = {-1, -1};
  pid_t pid_ = -1, memory_holder_ = -1;
  OwnedDescriptor pidfd_;
};

TEST_F(Deceased, IsOutlivedByItsUndertakerWhichEndsSoonAfterwards) {
  EXPECT_FALSE(has_memory_holder_ended(0));
  kill_it();
  EXPECT_TRUE(has_memory_holder_ended(kPatienceMs));
}

TEST_F(Deceased, ClosesItsDescriptorsByItsDeathAlone) {
  kill_it();
  char byte;
  EXPECT_EQ(::read(ends_[0], &byte, 1), 0) << "the other end is closed although the memory holder may still be there";
  EXPECT_TRUE(has_memory_holder_ended(kPatienceMs));
}

TEST_F(Deceased, HasAnUndertakerThatKeepsNothingButThePidfd) {
  const std::string folder = "/proc/" + std::to_string(memory_holder_) + "/fd/";
  const auto is_open = [&](int fd) { return ::access((folder + std::to_string(fd)).c_str(), F_OK) == 0; };
  for (int left = kPatienceMs; is_open(ends_[1]) && left > 0; --left) pause_ms(1);
  EXPECT_TRUE(is_open(0));
  for (int fd = 1; fd < 64; ++fd) EXPECT_FALSE(is_open(fd)) << fd;
}

TEST_F(Deceased, HasAnUndertakerThatOnlySigkillEnds) {
  const auto send = [&](int number) { ::syscall(SYS_pidfd_send_signal, pidfd_.fd, number, nullptr, 0); };
  for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) send(number);
  EXPECT_FALSE(has_memory_holder_ended(50));
  EXPECT_EQ(::kill(pid_, 0), 0) << "and it is nobody else who was hit";
  send(SIGKILL);
  EXPECT_TRUE(has_memory_holder_ended(kPatienceMs));
  EXPECT_EQ(::waitpid(pid_, nullptr, WNOHANG), 0) << "whose memory holder is gone lives on";
}

}  // namespace
}  // namespace chimera
