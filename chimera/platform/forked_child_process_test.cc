// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/forked_child.h"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>

#include "chimera/platform/shared_memory.h"

namespace chimera::forked_child_process_test {
namespace {

int status_of(const Result<pid_t>& child) {
  int status = -1;
  EXPECT_TRUE(child);
  if (child) ::waitpid(*child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(ForkedChild, EndsWithTheResultOfItsWork) {
  EXPECT_EQ(status_of(fork_quietly("", [] { return 7; })), 7);
}

TEST(ForkedChild, KeepsItsWritesToFamilyMemoryWhenKilled) {
  const auto memory = FamilyMemory::create(10'000);
  ASSERT_TRUE(memory);
  char* text = reinterpret_cast<char*>(memory->bytes().data());
  EXPECT_EQ(memory->bytes().size(), 10'000u);
  EXPECT_EQ(text[9'999], 0);
  EXPECT_EQ(status_of(fork_quietly("/",
                                   [text] {
                                     std::strcpy(text, std::filesystem::current_path().c_str());
                                     ::kill(::getpid(), SIGKILL);  // still ours
                                     return 0;
                                   })),
            -1);
  EXPECT_STREQ(text, "/");
}

TEST(ForkedChild, PrintsNothing) {
  EXPECT_EQ(status_of(fork_quietly("",
                                   [] {
                                     char name[100] = {};
                                     const bool is_known = ::readlink("/proc/self/fd/1", name, sizeof name - 1) > 0;
                                     return is_known && std::strcmp(name, "/dev/null") == 0 ? 0 : 1;
                                   })),
            0);
}

TEST(ForkedChild, EndsIfItsFolderIsMissing) {
  EXPECT_EQ(status_of(fork_quietly("/no/such/folder", [] { return 0; })), 1);
}

struct Counter final : ChildWatcher {
  void calls(std::uint64_t number) noexcept override { asked += number == SYS_getppid ? 1 : 0; }
  bool has_waited_enough() noexcept override { return looks++ >= patience; }

  int asked = 0;
  int looks = 0, patience = 1 << 30;
};

template <class Body>
bool watch(Body body, Counter& counter, ProcessEnd& end) {
  BlockedChildSignal blocked;
  const pid_t child = ::fork();
  if (child == 0) {
    blocked.undo();
    ::_exit(body());
  }
  return watch_child(child, counter, end);
}

TEST(WatchedChild, ReportsEachSystemCallOfATracedChild) {
  Counter counter;
  ProcessEnd end;
  const auto body = [] {
    if (!let_parent_trace()) return 77;
    for (int i = 0; i < 5; ++i) ::syscall(SYS_getppid);
    return 3;
  };
  EXPECT_FALSE(watch(body, counter, end));
  if (end.code == 77) GTEST_SKIP() << "the system allows no tracing";
  EXPECT_EQ(end.code, 3);
  EXPECT_EQ(counter.asked, 5);
}

TEST(WatchedChild, ReportsTheEndOfAnUntracedChild) {
  Counter counter;
  ProcessEnd end;
  EXPECT_FALSE(watch([] { return 4; }, counter, end));
  EXPECT_FALSE(end.by_signal);
  EXPECT_EQ(end.code, 4);
  EXPECT_FALSE(watch([] { return ::raise(SIGKILL); }, counter, end));
  EXPECT_TRUE(end.by_signal);
  EXPECT_EQ(end.code, SIGKILL);
  EXPECT_EQ(counter.asked, 0);
}

TEST(WatchedChild, EndsAHangingChild) {
  Counter counter;
  counter.patience = 3;
  ProcessEnd end;
  const auto body = [] {
    for (;;) ::pause();
    return 0;
  };
  EXPECT_TRUE(watch(body, counter, end));
  EXPECT_EQ(end.code, SIGKILL);
}

}  // namespace
}  // namespace chimera::forked_child_process_test
