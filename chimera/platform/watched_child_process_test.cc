// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/watched_child.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>
#include <ctime>

namespace chimera {
namespace {

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

TEST(WatchedChild, TellsEachSystemCallOfATracedChild) {
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

TEST(WatchedChild, SaysHowAnUntracedOneEnded) {
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

TEST(WatchedChild, EndsOneThatHangs) {
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
}  // namespace chimera
