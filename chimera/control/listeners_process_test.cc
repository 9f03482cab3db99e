// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/listeners.h"

#include <sys/prctl.h>
#include <sys/wait.h>

#include <csignal>

#include "chimera/control/testing/control_server_rig.h"

namespace chimera::control {
namespace {

using ListenersTest = DoorTest;

/// A child of that name that holds what this process holds.
struct Child {
  explicit Child(const char* name) : pid(::fork()) {
    if (pid != 0) return;
    ::prctl(PR_SET_NAME, name);
    for (;;) ::pause();
  }
  ~Child() {
    ::kill(pid, SIGKILL);  // still ours
    ::waitpid(pid, nullptr, 0);
  }
  pid_t pid;
};

Listeners await(const std::string& path, bool (*condition)(const Listeners&)) {
  Listeners found;
  EXPECT_TRUE(await_that([&] { return condition(found = listeners_at(path)); }));
  return found;
}

TEST_F(ListenersTest, AreTheKeeperAndTheManager) {
  EXPECT_EQ(listeners_at(path).manager, 0) << "this process is neither";
  const Child keeper("chimera"), manager("chimera-manager");
  Listeners found = await(path, [](const Listeners& l) { return l.keeper != 0 && l.manager != 0; });
  EXPECT_EQ(found.keeper, keeper.pid);
  EXPECT_EQ(found.manager, manager.pid);
  EXPECT_FALSE(found.is_stopped);
  ::kill(manager.pid, SIGSTOP);  // still ours
  EXPECT_TRUE(await(path, [](const Listeners& l) { return l.is_stopped; }).is_stopped);
  EXPECT_EQ(listeners_at(folder + "/./subject.sock").manager, manager.pid) << "for another spelling of the path";
  EXPECT_EQ(listeners_at(folder + "/other.sock").manager, 0);
}

TEST(SilenceText, NamesTheProcessAndTheRemedy) {
  EXPECT_EQ(
      silence_text("/run/arm.sock", {120, 123, false}, seconds(5)),
      "the manager (process 123) of 'arm' does not answer for 5 s: it hangs, or has too much to do; its rtpus "
      "go on without it; try again; `kill -KILL 123` has the keeper start another, `kill 120` ends "
      "everything in order");
  EXPECT_EQ(silence_text("/run/arm.sock", {120, 0, false}, seconds(5)),
            "no manager of 'arm' has answered for 5 s, none runs just now; its rtpus go on without it; try "
            "again: its keeper starts another; `kill 120` ends everything in order");
  EXPECT_EQ(silence_text("/run/arm.sock", {}, milliseconds(200)),
            "the manager of 'arm' does not answer for 200 ms; its rtpus go on without it; try again, or tell "
            "the user who started it");
}

}  // namespace
}  // namespace chimera::control
