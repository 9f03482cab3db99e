// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/rtpu_end.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "chimera/base/testing/await.h"
#include "chimera/platform/process.h"
#include "chimera/rtpu/testing/test_rtpus.h"

namespace chimera {
namespace {

using testing::component;

struct EndedGiver {
  Out<double> x{"x", "1", initial = 0.0};
  void cycle(Cycle) { *x = 1; }
};
struct EndedTaker {
  In<double> x{"x", "1"};
  void cycle(Cycle) {}
};

struct EndedLink {
  In<double> x{"x", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle) { *y = *x; }
};

constexpr TaskId kEndedGiver{0u}, kEndedTaker{1u};

// The taker, in its own rtpu, must go OFF before the giver.
struct RtpuEndTest : ::testing::Test {
  RtpuEndTest() {
    app.rtpus = {{"gives", 0, Policy::kEdf}, {"takes", 1, Policy::kEdf}};
    app.add("giver", component<EndedGiver>("giver")).rtpu = RtpuId(0u);
    app.add("taker", component<EndedTaker>("taker")).rtpu = RtpuId(1u);
    app.make({kEndedGiver, kEndedTaker}, false);
    rtpus = std::make_unique<testing::TestRtpus>(app);
    rtpus->run(milliseconds(1));
    rtpus->bring_up({kEndedGiver, kEndedTaker});
  }
  testing::TestRtpu& rtpu(std::size_t u) { return *rtpus->rtpus[u]; }
  RtpuEnd& end_of(std::size_t u) { return rtpu(u).edge->rtpu_end(); }
  PeerPhase phase(std::size_t u) { return rtpu(u).segment.block.head().phase; }

  testing::TestApplication app;
  std::unique_ptr<testing::TestRtpus> rtpus;
};

TEST_F(RtpuEndTest, KillsItsTasksAndSaysSo) {
  EXPECT_FALSE(end_of(1).is_told());
  end_of(1).tell(false);
  rtpus->change();
  rtpus->run(milliseconds(1100));  // its rtpu waits one second for the giver
  EXPECT_TRUE(end_of(1).is_over());
  EXPECT_EQ(rtpu(1).state(kEndedTaker), State::kNotCreated);
  EXPECT_EQ(phase(1), PeerPhase::kEnded);
  EXPECT_FALSE(end_of(0).is_over());
  EXPECT_EQ(rtpu(0).state(kEndedGiver), State::kOn) << "the other rtpu goes on";
}

TEST_F(RtpuEndTest, WaitsForTheConsumersOfOtherRtpus) {
  end_of(0).tell(false);
  rtpus->change();
  rtpus->run(milliseconds(500));
  EXPECT_FALSE(end_of(0).is_over());
  EXPECT_EQ(phase(0), PeerPhase::kEnding);
  EXPECT_EQ(rtpu(0).state(kEndedGiver), State::kOn);
  end_of(1).tell(false);
  rtpus->change();
  rtpus->run(milliseconds(5));
  EXPECT_TRUE(end_of(0).is_over());
}

// Both the keeper and that rtpu were killed: the keeper page still shows it as living.
TEST_F(RtpuEndTest, WaitsForNoDeadRtpuThoughNoKeeperShowsItsDeath) {
  const pid_t child = ::fork();
  if (child == 0) ::pause();
  rtpu(1).segment.block.head().pid = child;
  end_of(0).tell(false);
  rtpus->change();
  rtpus->run(milliseconds(5));
  EXPECT_FALSE(end_of(0).is_over()) << "that process lives";
  ::kill(child, SIGKILL);  // not reaped
  ASSERT_TRUE(await_that([child] { return has_process_ended(child); }));
  rtpus->run(milliseconds(5));
  EXPECT_TRUE(end_of(0).is_over());
  ::waitpid(child, nullptr, 0);
}

TEST_F(RtpuEndTest, EndsWithoutWaitingWhenAJobOfItsOwnHangs) {
  rtpu(0).edge->hanging().note(TaskWord(kEndedGiver, Method::kCycle), seconds(1), {});
  end_of(0).tell(false);
  rtpus->change();
  rtpus->run(milliseconds(5));
  EXPECT_TRUE(end_of(0).is_over());
}

TEST_F(RtpuEndTest, KeepsTheStatesForItsSuccessorWhenItEndsAlone) {
  end_of(1).tell(true);
  rtpus->change();
  rtpus->run(milliseconds(5));
  EXPECT_TRUE(end_of(1).is_over());
  EXPECT_EQ(rtpu(1).state(kEndedTaker), State::kOn) << "as the others are shown";
  EXPECT_EQ(rtpu(1).tasks->tasks()[kEndedTaker.index].state, State::kNotCreated);
}

// A chain of four tasks alternates between two rtpus, of which one is stopped.
TEST(RtpuEndChain, WaitsForAStoppedRtpuOnceAndNotForEachOfItsTasks) {
  testing::TestApplication app;
  app.rtpus = {{"mine", 0, Policy::kEdf}, {"stopped", 1, Policy::kEdf}};
  const std::vector<TaskId> chain = {TaskId(0u), TaskId(1u), TaskId(2u), TaskId(3u)};
  constexpr const char* kNames[] = {"x", "a", "b", "c"};
  app.add("giver", component<EndedGiver>("giver")).rtpu = RtpuId(0u);
  for (std::size_t t = 1; t < chain.size(); ++t) {
    app.add("link", component<EndedLink>("link")).rtpu = RtpuId(t % 2);
    app.link(t, 0, kNames[t - 1]);
    app.link(t, 1, kNames[t]);
  }
  app.make(chain, false);
  testing::TestRtpus rtpus(app);
  rtpus.run(milliseconds(1));
  rtpus.bring_up(chain);
  RtpuEnd& end = rtpus.rtpus[0]->edge->rtpu_end();
  end.tell(false);
  rtpus.change();
  rtpus.run(milliseconds(900));
  EXPECT_FALSE(end.is_over());
  rtpus.run(milliseconds(200));
  EXPECT_TRUE(end.is_over()) << "one second, the limit of a method";
}

}  // namespace
}  // namespace chimera
