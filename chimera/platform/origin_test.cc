// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/origin.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "chimera/platform/process.h"

namespace chimera {
namespace {

TEST(Origin, IsInheritedAndEverybodyOfItEnds) {
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
  EXPECT_TRUE(end_all_from(mine, seconds(20)));
  ProcessEnd end;
  EXPECT_TRUE(marked->wait(end, seconds(20).count));
  EXPECT_TRUE(end.by_signal);
  EXPECT_EQ(end.code, SIGKILL);
  for (Process* child : {&*other, &*none}) {
    EXPECT_FALSE(child->has_ended(end));
    child->signal(SIGKILL);
    EXPECT_TRUE(child->wait(end, seconds(20).count));
  }
}

TEST(Origin, OfOneThatIsGoneIsNone) {
  const pid_t pid = ::fork();
  if (pid == 0) ::_exit(0);
  ::waitpid(pid, nullptr, 0);
  EXPECT_EQ(origin_of(pid), "");
  EXPECT_EQ(name_of(pid), "");
}

}  // namespace
}  // namespace chimera
