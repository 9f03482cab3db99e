// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "chimera/base/testing/await.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/shared_memory.h"

namespace chimera::process_process_test {
namespace {

constexpr std::int64_t kLimit = kHangLimit.count;
constexpr int kLimitMs = static_cast<int>(kLimit / 1'000'000);

Result<Process> shell(const std::string& script, std::span<const int> descriptors = {}) {
  const std::array<const char*, 3> words = {"sh", "-c", script.c_str()};
  return Process::start("/bin/sh", words, descriptors);
}

// Returns what the child writes until its end; expects exit status 0. `ends`: of a pipe, the second one the child's.
std::string text_of(Process& child, const int (&ends)[2]) {
  ::close(ends[1]);
  std::string text;
  char bytes[512];
  for (ssize_t n; (n = ::read(ends[0], bytes, sizeof bytes)) > 0;) text.append(bytes, static_cast<std::size_t>(n));
  ::close(ends[0]);
  ProcessEnd end;
  EXPECT_TRUE(child.wait(end, kLimit));
  EXPECT_EQ(end.code, 0);
  return text;
}

// Returns the output of the script on its descriptor 3.
std::string output_of(const std::string& script, std::vector<int> more = {}) {
  int ends[2];
  EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  more.insert(more.begin(), ends[1]);
  auto child = shell(script, more);
  EXPECT_TRUE(child.has_value()) << child.error().message.view();
  return text_of(*child, ends);
}

TEST(Process, StartsApartWithoutStreamsAndDescriptorsOfItsParent) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);  // no close-on-exec: the child must not get them all the same
  const std::array<const char*, 3> words = {
      "sh", "-c", "ps -o sid= -p $$ | tr -d ' '; echo $$; cat; ls /proc/$$/fd | tr '\\n' ' '; echo error >&2"};
  auto child = Process::start_apart("/bin/sh", words, {.output = ends[1], .error = ends[1]});
  ASSERT_TRUE(child) << child.error().message.c_str();
  const std::string own = std::to_string(child->pid());
  EXPECT_EQ(text_of(*child, ends), own + "\n" + own + "\n0 1 2 error\n");
}

TEST(Process, BoundsTheFilesOfAChildInItsPlace) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  const std::array<const char*, 3> words = {"sh", "-c", "ulimit -f"};  // in 512 bytes
  auto child = Process::start_apart("/bin/sh", words, {.output = ends[1], .error = ends[1], .file = 1 << 20});
  ASSERT_TRUE(child) << child.error().message.c_str();
  EXPECT_EQ(text_of(*child, ends), "2048\n");
}

TEST(Process, EndsABoundChildWithItsParent) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  const pid_t parent = ::fork();
  if (parent == 0) {
    const std::array<const char*, 3> words = {"sh", "-c", "exec sleep 600"};
    const auto child = Process::start_apart("/bin/sh", words, {.output = ends[1], .error = ends[1], .is_bound = true});
    ::_exit(child ? 0 : 1);
  }
  ::close(ends[1]);
  int status = 0;
  EXPECT_EQ(::waitpid(parent, &status, 0), parent);
  EXPECT_EQ(status, 0);
  pollfd closed{ends[0], POLLIN, 0};  // the last writer is the child
  EXPECT_EQ(::poll(&closed, 1, kLimitMs), 1);
  ::close(ends[0]);
}

TEST(Process, ReportsTheEndOfItsChild) {
  auto child = shell("exit 7");
  ASSERT_TRUE(child.has_value()) << child.error().message.view();
  EXPECT_GT(child->pid(), 0);
  ProcessEnd end;
  ASSERT_TRUE(child->wait(end, kLimit));
  EXPECT_FALSE(end.by_signal);
  EXPECT_EQ(end.code, 7);
  EXPECT_FALSE(child->is_held());
  EXPECT_FALSE(child->has_ended(end)) << "once";
  EXPECT_FALSE(child->signal(SIGKILL));
}

TEST(Process, PidfdIsReadableAfterTheEnd) {
  auto child = shell("kill -9 $$");
  ASSERT_TRUE(child.has_value());
  pollfd ended{child->pidfd(), POLLIN, 0};
  ASSERT_EQ(::poll(&ended, 1, kLimitMs), 1);
  ProcessEnd end;
  ASSERT_TRUE(child->has_ended(end));
  EXPECT_TRUE(end.by_signal);
  EXPECT_EQ(end.code, SIGKILL);
}

TEST(Process, IsEndedByASignalToItsPidfd) {
  auto child = shell("exec sleep 100");
  ASSERT_TRUE(child.has_value());
  ProcessEnd end;
  EXPECT_FALSE(child->wait(end, 1'000'000));
  EXPECT_TRUE(child->signal(SIGKILL));
  ASSERT_TRUE(child->wait(end, kLimit));
  EXPECT_EQ(end.code, SIGKILL);
}

TEST(Process, InheritsPassedDescriptorsInOrderAndNoOthers) {
  const auto one = FrozenBytes::create("test", std::as_bytes(std::span("one\n", 4)));
  const auto two = FrozenBytes::create("test", std::as_bytes(std::span("two\n", 4)));
  const int careless = ::dup(2);  // not close-on-exec
  EXPECT_EQ(output_of("cat <&4 >&3; cat <&5 >&3; exec ls /proc/self/fd >&3", {one->descriptor(), two->descriptor()}),
            "one\ntwo\n0\n1\n2\n3\n4\n5\n6\n");  // 6: the listing itself reads the folder
  ::close(careless);
}

TEST(Process, PassesDescriptorsWithCrossedNumbers) {
  const auto one = FrozenBytes::create("test", std::as_bytes(std::span("one\n", 4)));
  const auto two = FrozenBytes::create("test", std::as_bytes(std::span("two\n", 4)));
  // The descriptors 4 and 5 of this process are restored afterwards.
  const int kept4 = ::fcntl(4, F_DUPFD_CLOEXEC, 20), kept5 = ::fcntl(5, F_DUPFD_CLOEXEC, 20);
  const int high1 = ::fcntl(one->descriptor(), F_DUPFD_CLOEXEC, 20);
  const int high2 = ::fcntl(two->descriptor(), F_DUPFD_CLOEXEC, 20);
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  const int out = ::fcntl(ends[1], F_DUPFD_CLOEXEC, 20), in = ::fcntl(ends[0], F_DUPFD_CLOEXEC, 20);
  ::close(ends[0]);
  ::close(ends[1]);
  ::dup2(high1, 5);
  ::dup2(high2, 4);
  const std::array<int, 3> crossed = {out, 5, 4};
  auto child = shell("cat <&4 >&3; cat <&5 >&3", crossed);
  for (const auto& [kept, place] : {std::pair(kept4, 4), std::pair(kept5, 5)}) {
    if (kept >= 0)
      ::dup3(kept, place, O_CLOEXEC);
    else
      ::close(place);
    if (kept >= 0) ::close(kept);
  }
  ::close(out);
  char text[16] = {};
  std::size_t size = 0;
  for (ssize_t n; (n = ::read(in, text + size, sizeof text - size)) > 0;) size += static_cast<std::size_t>(n);
  EXPECT_EQ(std::string(text, size), "one\ntwo\n");
  for (const int fd : {in, high1, high2}) ::close(fd);
  ProcessEnd end;
  ASSERT_TRUE(child.has_value());
  EXPECT_TRUE(child->wait(end, kLimit));
}

TEST(Process, StartsWithAnEmptySignalMaskAndIgnoresSignalsOfTheTerminal) {
  sigset_t some, before;
  sigemptyset(&some);
  sigaddset(&some, SIGTERM);
  sigaddset(&some, SIGCHLD);
  ::pthread_sigmask(SIG_BLOCK, &some, &before);
  const auto old = std::signal(SIGPIPE, SIG_IGN);
  EXPECT_EQ(output_of("grep -E 'SigBlk|SigIgn' /proc/self/status >&3"),
            "SigBlk:\t0000000000000000\nSigIgn:\t0000000001001003\n");
  std::signal(SIGPIPE, old);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST(Process, RefusesAProgramThatCannotBeStarted) {
  const std::array<const char*, 1> words = {"nothing"};
  const auto refused = Process::start("/nowhere/nothing", words, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().message.view(), "program /nowhere/nothing: exec failed: No such file or directory");
  const std::vector<const char*> many(1001, "x");
  EXPECT_EQ(Process::start("/bin/true", many, {}).error().message.view(),
            "program /bin/true: more than 1000 arguments or 16 descriptors");
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
}

TEST(Process, ChildFollowsItsParent) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  // The grandchild holds the write end until it dies; its parent dies at once.
  const pid_t parent = ::fork();
  if (parent == 0) {
    const pid_t me = ::getpid();
    if (::fork() == 0) {
      ::close(ends[0]);
      if (!follow_parent(me, SIGTERM)) ::_exit(1);
      if (::write(ends[1], "f", 1) != 1) ::_exit(2);
      for (;;) ::pause();
    }
    ::close(ends[1]);
    char byte = 0;
    const bool follows = ::read(ends[0], &byte, 1) == 1;
    ::_exit(follows ? 0 : 1);
  }
  ::close(ends[1]);
  int status = -1;
  ::waitpid(parent, &status, 0);
  EXPECT_EQ(status, 0);
  pollfd ended{ends[0], POLLIN, 0};
  EXPECT_EQ(::poll(&ended, 1, kLimitMs), 1) << "the grandchild lives on";
  ::close(ends[0]);
}

TEST(Process, ChildSeesThatItsParentIsGone) {
  EXPECT_FALSE(follow_parent(::getpid(), SIGTERM)) << "no process is its own parent";
  EXPECT_FALSE(signal_parent(::getpid(), SIGTERM)) << "and is not signalled as its parent";
  EXPECT_TRUE(signal_parent(::getppid(), 0));
  ::prctl(PR_SET_PDEATHSIG, 0);
}

TEST(Background, LowersTheChildAndNotItsParent) {
  constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;
  const int before = ::getpriority(PRIO_PROCESS, 0);
  const pid_t child = ::fork();
  if (child == 0) {
    run_in_background(kMemory);
    int score = 0;
    std::ifstream("/proc/self/oom_score_adj") >> score;
    rlimit core{}, addresses{};
    ::getrlimit(RLIMIT_CORE, &core);
    ::getrlimit(RLIMIT_AS, &addresses);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    const bool is_bound = addresses.rlim_cur == kMemory;
#else
    const bool is_bound = true;
#endif
    const bool gives_way = ::getpriority(PRIO_PROCESS, 0) >= 10;
    ::_exit((gives_way ? 0 : 1) | (score == 1000 ? 0 : 2) | (core.rlim_cur == 0 ? 0 : 4) | (is_bound ? 0 : 8));
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(::getpriority(PRIO_PROCESS, 0), before);
}

void pause_ms(long ms) {
  const timespec time{ms / 1000, ms % 1000 * 1'000'000};
  ::nanosleep(&time, nullptr);
}

// A child with a memory holder; killed at the end of the test at the latest.
class MemoryHolder : public ::testing::Test {
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
    if (!(children >> holder_)) GTEST_SKIP() << "this kernel lists no children of a thread";
    pidfd_ = OwnedDescriptor(static_cast<int>(::syscall(SYS_pidfd_open, holder_, 0)));
    ASSERT_GE(pidfd_.fd, 0);
  }
  void TearDown() override {
    if (pid_ > 0) kill_it();
    ::close(ends_[0]);
  }

  [[noreturn]] void live() {
    follow_parent(::getppid(), SIGKILL);  // an aborted test leaves no process behind
    const char granted = start_memory_holder() ? 'y' : 'n';
    if (::write(ends_[1], &granted, 1) != 1) ::_exit(1);
    while (true) ::pause();
  }
  void kill_it() {
    ::kill(pid_, SIGKILL);  // still ours: not reaped yet
    EXPECT_EQ(::waitpid(pid_, nullptr, 0), pid_);
    pid_ = -1;
  }
  bool has_ended(int limit_ms) const {
    pollfd ended{pidfd_.fd, POLLIN, 0};
    return ::poll(&ended, 1, limit_ms) == 1;
  }

  int ends_[2] = {-1, -1};
  pid_t pid_ = -1, holder_ = -1;
  OwnedDescriptor pidfd_;
};

TEST_F(MemoryHolder, OutlivesItsProcessAndEndsSoonAfterwards) {
  EXPECT_FALSE(has_ended(0));
  kill_it();
  EXPECT_TRUE(has_ended(kLimitMs));
}

TEST_F(MemoryHolder, LetsDescriptorsCloseAtTheDeathOfItsProcess) {
  kill_it();
  char byte;
  EXPECT_EQ(::read(ends_[0], &byte, 1), 0) << "closed although the memory holder may still live";
  EXPECT_TRUE(has_ended(kLimitMs));
}

TEST_F(MemoryHolder, KeepsThePidfdOnly) {
  const std::string folder = "/proc/" + std::to_string(holder_) + "/fd/";
  const auto is_open = [&](int fd) { return ::access((folder + std::to_string(fd)).c_str(), F_OK) == 0; };
  for (int left = kLimitMs; is_open(ends_[1]) && left > 0; --left) pause_ms(1);
  EXPECT_TRUE(is_open(0));
  for (int fd = 1; fd < 64; ++fd) EXPECT_FALSE(is_open(fd)) << fd;
}

TEST_F(MemoryHolder, IsEndedBySigkillOnly) {
  const auto send = [&](int number) { ::syscall(SYS_pidfd_send_signal, pidfd_.fd, number, nullptr, 0); };
  for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) send(number);
  EXPECT_FALSE(has_ended(50));
  EXPECT_EQ(::kill(pid_, 0), 0) << "the signals reached no other process";
  send(SIGKILL);
  EXPECT_TRUE(has_ended(kLimitMs));
  EXPECT_EQ(::waitpid(pid_, nullptr, WNOHANG), 0) << "the process survives its memory holder";
}

}  // namespace
}  // namespace chimera::process_process_test
