// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/own_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "chimera/base/testing/await.h"
#include "chimera/cli/run/under_way.h"
#include "chimera/runtime/making.h"
#include "chimera/task/abi.h"

namespace chimera::cli {
namespace {

/// The reported end of a child that does `work`, and 7; "returned" and its exit code if none was reported.
std::string end_of(const std::function<int()>& work) {
  std::string told = "returned";
  const int code = in_own_process(work, [&](const BrokenRun& broken) {
    told = broken.task.empty() ? broken.text : broken.task + ": " + broken.text;
    return 7;
  });
  return told + " " + std::to_string(code);
}

/// One task `amp` of `/lib/gain.so`, as a child would know it.
UnderWay& known() {
  UnderWay& place = under_way();
  std::snprintf(place.tasks[0].name, sizeof place.tasks[0].name, "amp");
  std::snprintf(place.tasks[0].object, sizeof place.tasks[0].object, "/lib/gain.so");
  place.n_tasks = 1;
  return place;
}

TEST(OwnProcess, ReturnsTheAnswerOfItsWork) {
  const pid_t here = ::getpid();
  EXPECT_EQ(end_of([] { return 0; }), "returned 0");
  EXPECT_EQ(end_of([here] { return ::getpid() == here ? 1 : 3; }), "returned 3") << "not in this process";
}

TEST(OwnProcess, NamesTheMethodInWhichItDied) {
  EXPECT_EQ(end_of([] { return ::raise(SIGKILL); }), "the run ended by signal 9 (SIGKILL) 7");
  EXPECT_EQ(end_of([] {
              show_making(known().making, 0, Making::kLoads);
              return ::raise(SIGKILL);
            }),
            "the run ended by signal 9 (SIGKILL) while it loaded /lib/gain.so, the component of task 'amp' 7");
  EXPECT_EQ(end_of([] {
              known().running = 1u << 8 | CHIMERA_CYCLE;
              ::_exit(0);
              return 0;
            }),
            "amp: the run ended with status 0 in amp.cycle 7");
}

TEST(OwnProcess, NamesAnOffOrKillThatDidNotReturn) {
  EXPECT_EQ(end_of([] {
              known().running = 1u << 8 | CHIMERA_OFF;
              return ::raise(SIGKILL);
            }),
            "amp: the run ended by signal 9 (SIGKILL) in amp.off: its hardware may not be off 7");
  EXPECT_EQ(end_of([] {
              known().serving = 1u << 8 | CHIMERA_KILL;
              under_way().is_ending = true;
              return ::pause();
            }),
            "amp: amp.kill did not return within 2 s: its hardware may not be off 7");
}

TEST(OwnProcess, EndsTheProcessesThatItsWorkLeftBehind) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  EXPECT_EQ(end_of([&] {
              ::close(ends[0]);
              for (const bool is_detached : {false, true}) {
                if (::fork() != 0) continue;
                if (is_detached && (::setsid(), ::fork() != 0)) ::_exit(0);
                for (;;) ::pause();
              }
              return 0;
            }),
            "returned 0");
  ::close(ends[1]);
  char byte;
  EXPECT_EQ(::read(ends[0], &byte, 1), 0) << "no process has the other end any more";
  ::close(ends[0]);
}

TEST(OwnProcess, EndsItsWorkIfItsParentWasKilledBeforeTheWorkBegan) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  const pid_t outer = ::fork();
  if (outer == 0) {
    static const pid_t kParent = ::getpid();
    ::pthread_atfork(nullptr, [] { ::raise(SIGKILL); }, [] { while (::getppid() == kParent) ::usleep(1000); });
    ::_exit(in_own_process([] { return static_cast<int>(::sleep(600)); }, [](const BrokenRun&) { return 7; }));
  }
  ::close(ends[1]);
  EXPECT_EQ(::waitpid(outer, nullptr, 0), outer);
  pollfd closed{ends[0], POLLIN, 0};  // the last writer is the child of the killed process
  EXPECT_EQ(::poll(&closed, 1, static_cast<int>(kHangLimit.count / 1'000'000)), 1);
  ::close(ends[0]);
}

TEST(OwnProcess, NamesAnExitThatDoesNotReturn) {
  EXPECT_EQ(end_of([] {
              std::atexit([] { for (;;) ::pause(); });
              return 0;
            }),
            "the run did not end within 10 s of its last method: an exit handler or destructor of a component does not "
            "return 7");
}

TEST(OwnProcess, TakesNoWordForGranted) {
  EXPECT_EQ(end_of([] {
              UnderWay& place = known();
              std::memset(place.tasks, 'x', sizeof place.tasks);
              place.n_tasks = 0xffffffff;
              place.running = place.serving = place.making = 0xdeadbeef;
              return ::raise(SIGKILL);
            }),
            "the run ended by signal 9 (SIGKILL) 7");
}

}  // namespace
}  // namespace chimera::cli
