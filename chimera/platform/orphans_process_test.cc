// SPDX-License-Identifier: Apache-2.0
// Each test of Orphans runs in a child: a process cannot stop to adopt orphans.
#include "chimera/platform/orphans.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "chimera/platform/clock.h"
#include "chimera/platform/process.h"

namespace chimera::orphans_process_test {
namespace {

constexpr auto kNoneLives = [](std::string_view) { return false; };

/// Runs `body` in a child: 0 if it returns true.
template <class Body>
int code_of(Body body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body() ? 0 : 1);
  int status = -1;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 256;
}

/// Runs `command` in a shell of that origin; true after the end of the shell.
bool has_run(const std::string& origin, const char* command) {
  ::setenv(kOriginVariable, origin.c_str(), 1);
  const std::array<const char*, 3> words = {"sh", "-c", command};
  auto shell = Process::start("/bin/sh", words, {});
  ProcessEnd end;
  return shell && shell->wait(end, seconds(60).count);
}

/// Calls look() until `left` children are left.
bool comes_to(Orphans& orphans, std::size_t left, std::function<bool(std::string_view)> lives = kNoneLives) {
  LinuxClock clock;
  for (const Nanoseconds until = clock.now() + seconds(60); clock.now() < until; ::usleep(1000)) {
    orphans.look({}, lives, clock.now());
    if (children_of_this_process().size() == left) return true;
  }
  return false;
}

TEST(Orphans, AreEndedIfTheirRtpuIsDeadOnly) {
  EXPECT_EQ(code_of([] {
              Orphans orphans;
              const std::string dead = orphans.prefix() + "0.1", alive = orphans.prefix() + "1.1";
              const auto lives = [&](std::string_view origin) { return origin == alive; };
              return has_run(dead, "sleep 1000 & setsid sleep 1000 & (sleep 1000 & sleep 1000) &") &&
                     has_run(alive, "sleep 1000 &") && comes_to(orphans, 1, lives) && comes_to(orphans, 0);
            }),
            0);
}

TEST(Orphans, HeldChildIsLeftToItsHolder) {
  EXPECT_EQ(code_of([] {
              Orphans orphans;
              ::setenv(kOriginVariable, (orphans.prefix() + "0.1").c_str(), 1);
              const std::array<const char*, 1> words = {"true"};
              auto held = Process::start("/bin/true", words, {});
              const pid_t pids[] = {held->pid()};
              ProcessEnd end;
              for (int i = 0; i < 50; ++i, ::usleep(1000)) orphans.look(pids, kNoneLives, {});
              return held->has_ended(end) && !end.by_signal;
            }),
            0);
}

TEST(Orphans, EndAllEndsProcessesWithoutOriginAndForkingChains) {
  EXPECT_EQ(code_of([] {
              Orphans orphans;
              const bool begun = has_run("", "env -u CHIMERA_ORIGIN sleep 1000 &") &&
                                 has_run(orphans.prefix() + "0.1", "chain() { (sleep 0.002; chain) & }; chain");
              LinuxClock clock;
              orphans.look({}, kNoneLives, clock.now());
              orphans.end_all(seconds(60));
              return begun && ::waitpid(-1, nullptr, WNOHANG) == -1;
            }),
            0);
}

TEST(Orphans, EndAllDoesNotNameAMemoryHolder) {
  EXPECT_EQ(code_of([] {
              std::FILE* const said = std::tmpfile();
              ::dup2(::fileno(said), STDERR_FILENO);
              Orphans orphans;
              const bool begun = has_run(orphans.prefix() + "0.1",
                                         "d=$(mktemp -d); cp /bin/sleep $d/memory-holder; "
                                         "$d/memory-holder 1000 & h=$!; sleep 1000 & "
                                         "until [ \"$(cat /proc/$h/comm /proc/$!/comm)\" = "
                                         "\"$(printf 'memory-holder\\nsleep')\" ]; do :; done; rm -r $d");
              orphans.end_all({});  // no time
              orphans.end_all(seconds(60));
              std::rewind(said);
              char text[200] = "";
              const std::size_t n = std::fread(text, 1, sizeof text - 1, said);
              const std::string_view all(text, n);
              return begun && all.ends_with(" (sleep), started by a component, could not be ended\n") &&
                     all.find("memory-holder") == all.npos;
            }),
            0);
}

// A shell that started something and then became `chimera run`.
TEST(Orphans, ChildFromBeforeIsNotEnded) {
  EXPECT_EQ(code_of([] {
              const std::array<const char*, 2> words = {"sleep", "1000"};
              auto before = Process::start("/bin/sleep", words, {});
              Orphans orphans;
              const bool begun = has_run(orphans.prefix() + "0.1", "sleep 1000 &");
              orphans.end_all(seconds(60));
              ProcessEnd end;
              const bool lives = !before->has_ended(end);
              const bool alone = children_of_this_process().size() == 1;
              before->signal(SIGKILL);
              return begun && lives && alone;
            }),
            0);
}

TEST(Origin, IsInheritedAndAllItsProcessesEnd) {
  const std::string mine = "origin_test." + std::to_string(::getpid());
  ::setenv(kOriginVariable, mine.c_str(), 1);
  const char* const words[] = {"sleep", "1000"};
  auto marked = Process::start("/bin/sleep", words, {});
  ::setenv(kOriginVariable, (mine + "1").c_str(), 1);
  auto other = Process::start("/bin/sleep", words, {});
  ::unsetenv(kOriginVariable);
  auto none = Process::start("/bin/sleep", words, {});
  ASSERT_TRUE(marked && other && none);
  EXPECT_EQ(origin_of(marked->pid()), mine);
  EXPECT_EQ(origin_of(other->pid()), mine + "1");
  EXPECT_EQ(origin_of(none->pid()), "");
  EXPECT_EQ(name_of(none->pid()), "sleep");
  const std::vector<pid_t> children = children_of_this_process();
  for (const Process* child : {&*marked, &*other, &*none})
    EXPECT_EQ(std::count(children.begin(), children.end(), child->pid()), 1);

  EXPECT_TRUE(end_all_from("", seconds(1)));
  EXPECT_TRUE(end_all_from(mine, seconds(60)));
  ProcessEnd end;
  EXPECT_TRUE(marked->wait(end, seconds(60).count));
  EXPECT_TRUE(end.by_signal);
  EXPECT_EQ(end.code, SIGKILL);
  for (Process* child : {&*other, &*none}) {
    EXPECT_FALSE(child->has_ended(end));
    child->signal(SIGKILL);
    EXPECT_TRUE(child->wait(end, seconds(60).count));
  }
}

TEST(Origin, IsEmptyForAGoneProcess) {
  const pid_t pid = ::fork();
  if (pid == 0) ::_exit(0);
  ::waitpid(pid, nullptr, 0);
  EXPECT_EQ(origin_of(pid), "");
  EXPECT_EQ(name_of(pid), "");
}

}  // namespace
}  // namespace chimera::orphans_process_test
