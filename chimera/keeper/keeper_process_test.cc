// SPDX-License-Identifier: Apache-2.0
// The keeper with real processes that log their messages (testing/child.cc).
#include "chimera/keeper/keeper.h"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <sstream>

#include "chimera/base/testing/await.h"
#include "chimera/keeper/testing/child_folder.h"
#include "chimera/platform/shared_memory.h"

namespace chimera {
namespace {

std::span<const std::byte> text(const char* words) { return std::as_bytes(std::span(words, std::strlen(words))); }

/// A keeper in a process of its own, with `n` rtpus, the manager and a run client; all children run testing/child.cc.
class KeeperProcess : public ::testing::Test, public testing::ChildFolder {
 protected:
  void TearDown() override {
    if (keeper_ > 0) {
      ::kill(keeper_, SIGKILL);  // not reaped yet: still its process id
      ::waitpid(keeper_, nullptr, 0);
    }
  }

  /// `limit`: time that the run client and the rtpus have to end.
  void start(std::uint32_t n, bool with_face = true, Nanoseconds limit = kHangLimit) {
    keeper_ = ::fork();
    if (keeper_ != 0) return;
    const auto image = FrozenBytes::create("image", text("the image"));
    const auto bundle = FrozenBytes::create("bundle", text("the bundle"));
    KeeperPlan plan{.peers = {.rtpu_program = KEEPER_TEST_CHILD,
                              .manager_program = KEEPER_TEST_CHILD,
                              .n_rtpus = n,
                              .image = image->descriptor(),
                              .objects = image->descriptor(),
                              .bundle = bundle->descriptor(),
                              .listening = 0},
                    .face = {},
                    .face_limit = limit,
                    .ending_limit = limit};
    if (with_face) plan.face = {KEEPER_TEST_CHILD, "face", std::to_string(::getpid())};
    Keeper keeper(plan);
    if (const auto started = keeper.start(); !started) ::_exit(99);
    ::_exit(keeper.run());
  }
  bool has(const std::string& line) const { return ("\n" + log()).find("\n" + line) != std::string::npos; }
  bool wait_for(const std::string& line) {
    return wait_for_times(line, 1);
  }
  bool wait_for_times(const std::string& line, int n) {
    const auto are_there = [&] {
      const std::string all = "\n" + log();
      int found = 0;
      for (std::size_t at = 0; (at = all.find("\n" + line, at)) != std::string::npos; ++at) ++found;
      return found >= n;
    };
    if (await_that(are_there)) return true;
    return ADD_FAILURE() << "no " << n << " lines '" << line << "' in\n" << log(), false;
  }
  /// Process id in the last line "WHO begin PID" of the log.
  pid_t pid_of(const std::string& who) {
    const std::string all = "\n" + log(), begin = "\n" + who + " begin ";
    const std::size_t at = all.rfind(begin);
    return at == std::string::npos ? 0 : std::stoi(all.substr(at + begin.size()));
  }
  /// Kills the last process that logged "WHO begin". Its parent has not reaped it, so its id is still valid.
  void kill_the(const std::string& who) {
    const int held = static_cast<int>(::syscall(SYS_pidfd_open, pid_of(who), 0));
    EXPECT_EQ(::syscall(SYS_pidfd_send_signal, held, SIGKILL, nullptr, 0), 0) << who;
    ::close(held);
  }
  int code_of_keeper() {
    int status = 0;
    EXPECT_EQ(::waitpid(keeper_, &status, 0), keeper_);
    keeper_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
  }
  /// False for a zombie: in some containers process 1 does not reap.
  static bool lives(pid_t pid) { return ::kill(pid, 0) == 0 && process_state(pid).letter != 'Z'; }
  /// True when every process that ever began is gone.
  bool nobody_is_left() {
    std::istringstream all(log());
    std::vector<pid_t> pids;
    for (std::string line; std::getline(all, line);)
      if (const auto at = line.find(" begin "); at != std::string::npos) pids.push_back(std::stoi(line.substr(at + 7)));
    return await_that([&] { return std::none_of(pids.begin(), pids.end(), &lives); });
  }

  pid_t keeper_ = 0;
};

TEST_F(KeeperProcess, StartsAllPeersAndPassesTheirMemoryOn) {
  start(2);
  EXPECT_TRUE(wait_for("0.1 peer 1 1 by-1.1"));
  EXPECT_TRUE(wait_for("0.1 peer 2 1 by-2.1"));
  EXPECT_TRUE(wait_for("1.1 peer 0 1 by-0.1"));
  EXPECT_TRUE(wait_for("2.1 peer 0 1 by-0.1"));
  EXPECT_TRUE(wait_for("2.1 peer 1 1 by-1.1"));
  EXPECT_TRUE(has("2.1 started 0 1 alive"));
  EXPECT_TRUE(has("2.1 started 1 1 alive"));
  EXPECT_TRUE(has("2.1 complete"));
  EXPECT_TRUE(has("0.1 begin " + std::to_string(pid_of("0.1")) + " image 9 alive 1\n"));
  EXPECT_TRUE(has("2.1 begin " + std::to_string(pid_of("2.1")) + " image 9 alive 1 bundle 10\n"));
  EXPECT_FALSE(has("0.1 started")) << "that is for the manager";
  EXPECT_TRUE(wait_for("face begin"));
  order("face", "exit 3");
  EXPECT_EQ(code_of_keeper(), 3);
  EXPECT_TRUE(has("0.1 finish"));
  EXPECT_TRUE(has("1.1 finish"));
  EXPECT_TRUE(has("2.1 finish"));
  EXPECT_TRUE(nobody_is_left());
}

TEST_F(KeeperProcess, ANewManagerReceivesTheLivesAndMemoryOfAllPeers) {
  start(2);
  ASSERT_TRUE(wait_for("1.1 peer 2 1"));
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));  // the keeper has the memory of all three
  order("1", "exit 4");
  ASSERT_TRUE(wait_for("2.1 ended 1 1 exit 4"));
  kill_the("2.1");
  ASSERT_TRUE(wait_for("2.2 complete"));
  const std::string all = log();
  const std::string told = all.substr(all.find("2.2 started"), all.find("2.2 complete") - all.find("2.2 started"));
  std::string order_of_telling;
  std::istringstream lines(told);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("2.2 ")) order_of_telling += line.substr(4) + "\n";
  EXPECT_EQ(order_of_telling,
            "started 0 1 alive\npeer 0 1 by-0.1\npeer 1 1 by-1.1\nended 1 1 exit 4\npeer 2 1 by-2.1\n");
  EXPECT_TRUE(wait_for("0.1 peer 2 2 by-2.2"));
}

TEST_F(KeeperProcess, AnRtpuIsStartedAgainWhenTheManagerSaysSo) {
  start(2);
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));
  order("2", "changes");
  ASSERT_TRUE(wait_for("2.1 changes 3"));
  order("0.1", "crash");
  ASSERT_TRUE(wait_for("2.1 ended 0 1 signal 11"));
  order("2", "changes");
  ASSERT_TRUE(wait_for("2.1 changes 4"));
  order("2", "start 1");  // 2 lives already: the order has no effect
  order("2", "start 0");
  ASSERT_TRUE(wait_for("2.1 started 0 2 alive"));
  ASSERT_TRUE(wait_for("2.1 peer 0 2 by-0.2"));
  ASSERT_TRUE(wait_for("0.2 peer 1 1 by-1.1"));
  ASSERT_TRUE(wait_for("0.2 peer 2 1 by-2.1"));
  EXPECT_TRUE(has("0.2 begin " + std::to_string(pid_of("0.2")) + " image 9 alive 2"));
  EXPECT_FALSE(has("1.2 begin"));
  EXPECT_FALSE(has("0.2 peer 0 1")) << "only the manager gets its predecessor's memory";
}

TEST_F(KeeperProcess, TheManagerMayEndAnRtpuThatHangs) {
  start(1);
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));
  order("0", "stubborn");
  order("1", "kill 0");
  EXPECT_TRUE(wait_for("1.1 ended 0 1 signal 9"));
}

TEST_F(KeeperProcess, TheManagerMayEndEverythingWithItsCode) {
  start(1);
  ASSERT_TRUE(wait_for("face begin"));
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));
  order("1", "end 6");
  EXPECT_EQ(code_of_keeper(), 6);
  EXPECT_TRUE(has("face finishes"));
  EXPECT_TRUE(nobody_is_left());
}

TEST_F(KeeperProcess, SignalsEndEverythingWithTheCodeOfTheFace) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    clear_log();
    start(1);
    ASSERT_TRUE(wait_for("face begin"));
    ASSERT_TRUE(wait_for("1.1 peer 0 1"));
    ::kill(keeper_, number);  // not reaped yet: still its process id
    EXPECT_EQ(code_of_keeper(), 5) << number;
    const std::string all = log();
    EXPECT_LT(all.find("face finishes"), all.find("0.1 finish"));
    EXPECT_LT(all.find("0.1 finish"), all.find("1.1 finish"));
    EXPECT_TRUE(nobody_is_left());
  }
}

TEST_F(KeeperProcess, AFaceThatWaitsSeesTheEndsOfAllPeers) {
  start(1);
  ASSERT_TRUE(wait_for("face begin"));
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));
  order("face", "look");
  EXPECT_TRUE(wait_for("1.1 ended 0 1")) << "the rtpu has ended, the manager and the face have not";
  EXPECT_FALSE(has("1.1 finish"));
  order("face", "exit 4");
  EXPECT_EQ(code_of_keeper(), 4);
  EXPECT_TRUE(has("1.1 finish"));
  EXPECT_TRUE(nobody_is_left());
}

TEST_F(KeeperProcess, ASignalToTheKeeperIsNoCommandOfTheFace) {
  start(1);
  ASSERT_TRUE(wait_for("face begin"));
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));
  ::kill(keeper_, SIGUSR1);  // not reaped yet: still its process id
  order("1", "kill 0");
  EXPECT_TRUE(wait_for("1.1 ended 0 1 signal 9")) << "it still keeps";
  ::kill(keeper_, SIGTERM);  // not reaped yet: still its process id
  EXPECT_EQ(code_of_keeper(), 5);
}

TEST_F(KeeperProcess, EndsWithoutAFaceToo) {
  start(1, false);
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));
  ::kill(keeper_, SIGTERM);  // not reaped yet: still its process id
  EXPECT_EQ(code_of_keeper(), 0);
  EXPECT_TRUE(nobody_is_left());
}

TEST_F(KeeperProcess, KillsAPeerThatDoesNotFinishWithinItsLimit) {
  ::setenv("CHIMERA_TEST_DEAF", "1", 1);
  start(2, true, milliseconds(200));
  ASSERT_TRUE(wait_for("face begin"));
  ASSERT_TRUE(wait_for("2.1 peer 0 1"));
  order("0", "stubborn");
  order("2", "stubborn");
  ASSERT_TRUE(wait_for("0.1 is stubborn"));
  ASSERT_TRUE(wait_for("2.1 is stubborn"));
  ::kill(keeper_, SIGINT);  // not reaped yet: still its process id
  EXPECT_EQ(code_of_keeper(), 1) << "no face has judged the run";
  EXPECT_TRUE(nobody_is_left());
}

TEST_F(KeeperProcess, AFaceThatDiesBySignalIsReplacedAndTheRunGoesOn) {
  start(1);
  ASSERT_TRUE(wait_for("face begin"));
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));
  kill_the("face");
  order("1", "kill 0");
  EXPECT_TRUE(wait_for("1.1 ended 0 1 signal 9")) << "it still keeps";
  ASSERT_TRUE(wait_for_times("face begin", 2));
  order("face", "exit 3");
  EXPECT_EQ(code_of_keeper(), 3) << "that of the second one";
  EXPECT_TRUE(nobody_is_left());
}

TEST_F(KeeperProcess, AFaceThatDiesAgainAndAgainEndsEverything) {
  start(1);
  ASSERT_TRUE(wait_for("1.1 peer 0 1"));
  for (int n = 1; n <= kMostFaceDeaths; ++n) {
    ASSERT_TRUE(wait_for_times("face begin", n));
    kill_the("face");
  }
  EXPECT_EQ(code_of_keeper(), 1);
  EXPECT_TRUE(has("0.1 finish")) << "in order";
  EXPECT_TRUE(nobody_is_left());
}

TEST_F(KeeperProcess, NoProcessIsLeftWhenTheKeeperIsKilled) {
  start(2);
  ASSERT_TRUE(wait_for("face begin"));
  ASSERT_TRUE(wait_for("2.1 peer 1 1"));
  ASSERT_TRUE(wait_for("2.1 peer 0 1"));
  ::kill(keeper_, SIGKILL);  // not reaped yet: still its process id
  EXPECT_EQ(code_of_keeper(), 256 + SIGKILL);
  EXPECT_TRUE(nobody_is_left());
}

TEST_F(KeeperProcess, AManagerThatDiesAgainAndAgainIsStartedMoreAndMoreSlowly) {
  order("1", "exit 1");
  start(1);
  ASSERT_TRUE(wait_for("1.6 begin"));  // pauses of 0, 10, 20, 40 and 80 ms
  EXPECT_TRUE(::kill(pid_of("0.1"), 0) == 0) << "the rtpu goes on";
  ::kill(keeper_, SIGTERM);  // not reaped yet: still its process id
  EXPECT_EQ(code_of_keeper(), 5);
}

TEST(Keeper, RefusesProgramsThatCannotBeStartedAndLeavesNoProcess) {
  const PeerPlan peers{.rtpu_program = "/nowhere/chimera-rtpu",
                       .manager_program = "/bin/true",
                       .n_rtpus = 1,
                       .image = 0,
                       .objects = 0,
                       .bundle = 0,
                       .listening = 0};
  Keeper keeper({.peers = peers, .face = {}});
  const auto started = keeper.start();
  ASSERT_FALSE(started.has_value());
  EXPECT_EQ(started.error().message.view(), "program /nowhere/chimera-rtpu: exec failed: No such file or directory");
}

}  // namespace
}  // namespace chimera
