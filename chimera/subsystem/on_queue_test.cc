// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/on_queue.h"

#include <gtest/gtest.h>

#include "chimera/subsystem/testing/test_parts.h"

namespace chimera::subsystem {
namespace {

class OnQueueTest : public ::testing::Test, public TestParts {
 protected:
  explicit OnQueueTest(bool spare_serves = true) : TestParts(spare_serves) {}
  std::string advance() {
    (void)queue.advance();
    return taken();
  }
  /// The rtpu reports to the transaction, and the next transaction begins.
  std::string report(TaskId task, State after) {
    transaction.on_result(reported(task, after));
    (void)transaction.advance();
    return advance();
  }
  void ask(std::uint64_t id, std::vector<TaskId> tasks) { queue.add(Commanded{id, Signal::kOn, std::move(tasks)}); }

  OnQueue queue{state, goals, transaction};
};

TEST_F(OnQueueTest, BeginsOneTransactionAfterTheOther) {
  ask(1, {kTraj});
  ask(2, {kPid, kArm});
  EXPECT_EQ(advance(), "goal traj 2\nsend spare: on traj\n");
  EXPECT_FALSE(queue.advance()) << "one is under way";
  EXPECT_EQ(report(kTraj, State::kOn),
            "goal traj 0\nanswer 1 yes traj OFF>ON\ngoal arm 2\ngoal pid 2\nsend servo: on arm pid\n");
}

TEST_F(OnQueueTest, ALaterRequestPassesAWaitingOne) {
  goals.add(kArm, kGoalSpawn);
  (void)taken();
  ask(1, {kArm, kPid});
  ask(2, {kTraj});
  EXPECT_EQ(advance(), "goal traj 2\nsend spare: on traj\n");
}

TEST_F(OnQueueTest, TakesARequestOfATaskOnce) {
  const Requested request{kTraj, Signal::kOn, kArm};
  queue.add(request);
  queue.add(request);
  EXPECT_EQ(advance(), "goal traj 2\nsend spare: on traj\n");
  EXPECT_EQ(report(kTraj, State::kOn), "goal traj 0\nsignal: on sent by arm: traj is ON\n")
      << "a second one would be refused";
}

TEST_F(OnQueueTest, RefusesATaskThatWouldTurnOnWhatAPersonTurnedOff) {
  goals.add(kTraj, kGoalOff);
  (void)taken();
  queue.add(Requested{kTraj, Signal::kOn, kArm});
  EXPECT_EQ(advance(), "refused: on sent by arm: an operator turned traj OFF; `chimera on traj` turns it ON\n");
  ask(1, {kTraj});
  EXPECT_FALSE(goals.has(kTraj, kGoalOff));
  EXPECT_EQ(advance(), "goal traj 2\nsend spare: on traj\n");
}

TEST_F(OnQueueTest, IgnoresATaskThatDoesNotExist) {
  queue.add(Requested{TaskId(9u), Signal::kOn, kArm});
  queue.add(Requested{kTraj, Signal::kOn, TaskId(9u)});
  EXPECT_FALSE(queue.advance());
  EXPECT_EQ(taken(), "");
}

TEST_F(OnQueueTest, GoalsGoBeforeWaitingCommands) {
  goals.add(kTraj, kGoalOn);
  (void)taken();
  ask(1, {kArm, kPid});
  EXPECT_EQ(advance(), "send spare: on traj\n");
  EXPECT_EQ(report(kTraj, State::kOn),
            "goal traj 0\nstarted: traj is ON\ngoal arm 2\ngoal pid 2\nsend servo: on arm pid\n");
}

TEST_F(OnQueueTest, GoalsToTurnOnWaitUntilEverythingIsSpawned) {
  goals.add(kTraj, kGoalOn);
  goals.add(kReserve, kGoalSpawn);
  (void)taken();
  EXPECT_EQ(advance(), "");
  goals.clear(kReserve, kGoalSpawn);
  (void)taken();
  EXPECT_EQ(advance(), "send spare: on traj\n");
}

TEST_F(OnQueueTest, LeavesOutAGoalWhoseTaskFailed) {
  are_on({kTraj, kPid});
  for (TaskId task : {kArm, kReserve}) goals.add(task, kGoalOn);
  is(kReserve, State::kNotCreated);
  (void)taken();
  EXPECT_EQ(advance(),
            "refused: reserve is in state NOT-CREATED, where on is not legal; type `chimera spawn reserve`, then "
            "`chimera on reserve`\ngoal reserve 0\nsend servo: on arm\n");
}

TEST_F(OnQueueTest, WaitsForATaskWhoseMethodRuns) {
  is(kTraj, State::kOff, true);
  ask(1, {kTraj});
  EXPECT_EQ(advance(), "");
  is(kTraj, State::kOff);
  EXPECT_EQ(advance(), "goal traj 2\nsend spare: on traj\n");
}

TEST_F(OnQueueTest, WaitsForTheOffOfARival) {
  are_on({kArm, kTraj, kPid});
  (void)state.send(Signal::kOff, {&kPid, 1});
  (void)taken();
  ask(1, {kReserve});
  EXPECT_EQ(advance(), "") << "and is not refused for two producers";
  (void)reported(kPid, State::kOff);
  EXPECT_EQ(advance(), "goal reserve 2\nsend spare: on reserve\n");
}

TEST_F(OnQueueTest, ARequestThatAGoalFulfilsIsDoneWithoutASignal) {
  goals.add(kTraj, kGoalSpawn | kGoalOn);
  (void)taken();
  ask(1, {kTraj});
  EXPECT_EQ(advance(), "");
  goals.clear(kTraj, kGoalSpawn | kGoalOn);
  is(kTraj, State::kOn);
  EXPECT_EQ(advance(), "goal traj 0\nanswer 1 yes traj OFF>ON\n");
}

TEST_F(OnQueueTest, ACommandForNoTaskIsDoneAtOnce) {
  ask(1, {});
  EXPECT_EQ(advance(), "answer 1 yes\n");
}

// An rtpu that does not serve this manager is waited for, at most two seconds from the request on.
class MuteOnQueueTest : public OnQueueTest {
 protected:
  MuteOnQueueTest() : OnQueueTest(false) {
    pass(seconds(5));
    ask(1, {kTraj});
  }
};

TEST_F(MuteOnQueueTest, IsRefusedAfterTwoSeconds) {
  EXPECT_EQ(waits(queue), "2 s: answer 1 no: no answer from rtpu spare\n");
}

TEST_F(MuteOnQueueTest, BeginsWhenTheRtpuServes) {
  state.observed.up(kSpare, 1);
  EXPECT_EQ(queue.next_due(), kNever);
  EXPECT_EQ(advance(), "goal traj 2\nsend spare: on traj\n");
}

}  // namespace
}  // namespace chimera::subsystem
