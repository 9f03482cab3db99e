// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>

#include "chimera/platform/frozen_bytes.h"

namespace chimera {
namespace {

constexpr std::int64_t kLimit = 20'000'000'000;

Result<Process> shell(const std::string& script, std::span<const int> descriptors = {}) {
  const std::array<const char*, 3> words = {"sh", "-c", script.c_str()};
  return Process::start("/bin/sh", words, descriptors);
}

// What the script writes to its descriptor 3, and that it ended well.
std::string output_of(const std::string& script, std::vector<int> more = {}) {
  int ends[2];
  EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  more.insert(more.begin(), ends[1]);
  auto child = shell(script, more);
  EXPECT_TRUE(child.has_value()) << child.error().message.view();
  ::close(ends[1]);
  std::string text;
  char bytes[512];
  for (ssize_t n; (n = ::read(ends[0], bytes, sizeof bytes)) > 0;) text.append(bytes, static_cast<std::size_t>(n));
  ::close(ends[0]);
  ProcessEnd end;
  EXPECT_TRUE(child->wait(end, kLimit));
  EXPECT_EQ(end.code, 0);
  return text;
}

TEST(Process, TellsHowItsChildEnded) {
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

TEST(Process, ItsPidfdIsReadableWhenItEnded) {
  auto child = shell("kill -9 $$");
  ASSERT_TRUE(child.has_value());
  pollfd ended{child->pidfd(), POLLIN, 0};
  ASSERT_EQ(::poll(&ended, 1, 20'000), 1);
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

TEST(Process, InheritsWhatIsPassedInItsOrderAndNothingElse) {
  const auto one = FrozenBytes::create("test", std::as_bytes(std::span("one\n", 4)));
  const auto two = FrozenBytes::create("test", std::as_bytes(std::span("two\n", 4)));
  const int careless = ::dup(2);  // not close-on-exec
  EXPECT_EQ(output_of("cat <&4 >&3; cat <&5 >&3; exec ls /proc/self/fd >&3",
                      {one->descriptor(), two->descriptor()}),
            "one\ntwo\n0\n1\n2\n3\n4\n5\n6\n");  // 6: the listing itself reads the folder
  ::close(careless);
}

TEST(Process, PassesDescriptorsThatStandInEachOthersPlace) {
  const auto one = FrozenBytes::create("test", std::as_bytes(std::span("one\n", 4)));
  const auto two = FrozenBytes::create("test", std::as_bytes(std::span("two\n", 4)));
  // Whatever stands at 4 and 5 of this process comes back afterwards.
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
    if (kept >= 0) ::dup3(kept, place, O_CLOEXEC);
    else ::close(place);
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

TEST(Process, StartsWithAnEmptySignalMaskAndIgnoresWhatTheTerminalSends) {
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

TEST(Process, AChildFollowsItsParent) {
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
  EXPECT_EQ(::poll(&ended, 1, 20'000), 1) << "the grandchild lives on";
  ::close(ends[0]);
}

TEST(Process, AChildSeesThatItsParentIsGoneAlready) {
  EXPECT_FALSE(follow_parent(::getpid(), SIGTERM)) << "no process is its own parent";
  EXPECT_FALSE(signal_parent(::getpid(), SIGTERM)) << "nor is it signalled as that";
  EXPECT_TRUE(signal_parent(::getppid(), 0));
  ::prctl(PR_SET_PDEATHSIG, 0);
}

}  // namespace
}  // namespace chimera
