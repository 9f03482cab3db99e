// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/command_queue.h"

#include <gtest/gtest.h>

#include "chimera/subsystem/testing/test_parts.h"

namespace chimera::subsystem {
namespace {

class CommandQueueTest : public ::testing::Test, public TestParts {
 protected:
  explicit CommandQueueTest(bool spare_serves = true) : TestParts(spare_serves) {}
  /// Adds a command with the next number 1, 2, ... and advances the queue.
  std::string ask(Signal signal, std::vector<TaskId> tasks) {
    queue.add(Commanded{++last, signal, std::move(tasks)});
    return advance();
  }
  std::string advance() {
    (void)queue.advance();
    return taken();
  }
  std::string report(TaskId task, State after, SignalRefusal why = {}) {
    const SignalResult result = reported(task, after, std::move(why));
    goals.on_result(result);
    queue.on_result(result);
    return advance();
  }
  void die(RtpuId rtpu) { state.observed.down(rtpu, 1); }

  CommandQueue queue{state, goals, transaction};
  std::uint64_t last = 0;
};

TEST_F(CommandQueueTest, SendsAgainstTheDataFlowAndAnswersWhenAllHaveReported) {
  are_on({kArm, kTraj, kPid});
  EXPECT_EQ(ask(Signal::kOff, {kArm, kTraj, kPid}),
            "send servo: off pid\nsend spare: off traj\nsend servo: off arm\n");
  EXPECT_EQ(report(kTraj, State::kOff), "");
  EXPECT_EQ(report(kArm, State::kOff), "");
  EXPECT_EQ(report(kPid, State::kOff), "answer 1 yes pid ON>OFF traj ON>OFF arm ON>OFF\n");
  EXPECT_FALSE(queue.advance()) << "nothing is left";
}

TEST_F(CommandQueueTest, SendsNeighboursOfOneRtpuInOneList) {
  are_on({kArm, kPid});
  EXPECT_EQ(ask(Signal::kOff, {kArm, kPid}), "send servo: off pid arm\n");
}

TEST_F(CommandQueueTest, RefusesTheWholeListForOneWrongTask) {
  are_on({kArm});
  is(kTraj, State::kError);
  EXPECT_EQ(ask(Signal::kClear, {kTraj, kArm}),
            "answer 1 no: arm is in state ON, where clear is not legal; type `chimera clear traj`\n");
}

TEST_F(CommandQueueTest, ReportsCompletedTasksThoughAnotherFailed) {
  are_on({kArm, kPid});
  ask(Signal::kOff, {kArm, kPid});
  EXPECT_EQ(report(kPid, State::kError, {RefusalKind::kFault, "no answer from the drive", {}}), "");
  EXPECT_EQ(report(kArm, State::kOff), "answer 1 no: off: pid: no answer from the drive pid ON>ERROR arm ON>OFF\n");
}

TEST_F(CommandQueueTest, ATaskThatIsOffReceivesNoOff) {
  EXPECT_EQ(ask(Signal::kOff, {kArm}), "answer 1 yes arm OFF>OFF already\n");
}

TEST_F(CommandQueueTest, TakesOnlyTheReportOnItsOwnSignal) {
  are_on({kArm});
  ask(Signal::kOff, {kArm});
  queue.on_result({sent[kArm.index].command - 1, kArm, Signal::kOff, State::kOn, State::kOff, {}});
  EXPECT_EQ(advance(), "");
  EXPECT_EQ(report(kArm, State::kOff), "answer 1 yes arm ON>OFF\n");
}

TEST_F(CommandQueueTest, ASpawnIsAGoalAndEndsWithIt) {
  is(kReserve, State::kNotCreated);
  EXPECT_EQ(ask(Signal::kSpawn, {kReserve}), "goal reserve 1\n");
  (void)goals.advance();
  EXPECT_EQ(advance(), "send spare: spawn reserve\n");
  EXPECT_EQ(report(kReserve, State::kOff), "goal reserve 0\nanswer 1 yes reserve NOT-CREATED>OFF\n");
}

TEST_F(CommandQueueTest, ASpawnWhoseInitFailsIsRefusedWithTheFault) {
  is(kReserve, State::kNotCreated);
  ask(Signal::kSpawn, {kReserve});
  (void)goals.advance();
  (void)taken();
  EXPECT_EQ(report(kReserve, State::kNotCreated, {RefusalKind::kFault, "no memory", {}}),
            "fault: spawn: reserve: no memory\ngoal reserve 0\nanswer 1 no: spawn: reserve: no memory reserve "
            "NOT-CREATED>NOT-CREATED\n");
}

TEST_F(CommandQueueTest, ASpawnWaitsForAnInitThatRunsAndIsMetByIt) {
  is(kReserve, State::kNotCreated, true);
  EXPECT_EQ(ask(Signal::kSpawn, {kReserve}), "");
  is(kReserve, State::kOff);
  EXPECT_EQ(advance(), "answer 1 yes reserve NOT-CREATED>OFF\n");
}

TEST_F(CommandQueueTest, OffTakesAGoalBackAndSendsNothing) {
  goals.add(kPid, kGoalOn);
  (void)taken();
  EXPECT_EQ(ask(Signal::kOff, {kPid}), "goal pid 0\nanswer 1 yes pid OFF>OFF\n") << "it was not done already";
}

TEST_F(CommandQueueTest, OffWithdrawsATaskFromTheTransactionThatTurnsItOn) {
  transaction.begin({9, {kTraj}, TaskId{}, false});
  (void)transaction.advance();
  (void)taken();
  EXPECT_EQ(ask(Signal::kOff, {kTraj}), "goal traj 0\nsend spare: off traj\n") << "after the on, in its order";
  EXPECT_FALSE(transaction.withdraw(kTraj, Signal::kOff)) << "withdrawn already";
}

TEST_F(CommandQueueTest, KillWaitsForTheInitThatRuns) {
  is(kReserve, State::kNotCreated, true);
  EXPECT_EQ(ask(Signal::kKill, {kReserve}), "");
  is(kReserve, State::kOff);
  EXPECT_EQ(advance(), "send spare: kill reserve\n");
  EXPECT_EQ(report(kReserve, State::kNotCreated), "answer 1 yes reserve OFF>NOT-CREATED\n");
}

TEST_F(CommandQueueTest, KillOfATaskThatWasLostMakesItNoLongerMissed) {
  die(kSpare);
  EXPECT_EQ(ask(Signal::kKill, {kReserve}), "goal reserve 4\nanswer 1 yes reserve ERROR>NOT-CREATED\n");
  EXPECT_FALSE(state.observed.is_lost(kReserve));
}

TEST_F(CommandQueueTest, ClearOfALostTaskStartsItsRtpuAndTheOtherWantedTasks) {
  die(kSpare);
  state.observed.want_back(kReserve, true);
  EXPECT_EQ(ask(Signal::kClear, {kTraj}), "goal traj 1\ngoal reserve 1\nrestart spare\nstart spare\n");
  EXPECT_EQ(state.observed.life(kSpare), RtpuLife::kStarting);
  goals.clear(kTraj, kGoalSpawn);
  is(kTraj, State::kOff);
  (void)taken();
  EXPECT_EQ(advance(), "answer 1 yes traj ERROR>OFF\n");
}

TEST_F(CommandQueueTest, AnInitThatEndsItsProcessIsNotTriedAgain) {
  die(kSpare);
  ask(Signal::kClear, {kTraj});
  die(kSpare);
  queue.on_rtpu_down(kServo, "ended by signal 9");
  EXPECT_EQ(advance(), "") << "another rtpu";
  queue.on_rtpu_down(kSpare, "ended by signal 11");
  EXPECT_EQ(advance(), "goal traj 0\nanswer 1 no: spare ended by signal 11 traj ERROR>ERROR\n");
}

class MuteCommandQueueTest : public CommandQueueTest {
 protected:
  MuteCommandQueueTest() : CommandQueueTest(false) {}
};

TEST_F(MuteCommandQueueTest, WaitsTwoSecondsForTheRtpu) {
  are_on({kTraj});
  pass(seconds(5));
  EXPECT_EQ(ask(Signal::kOff, {kTraj}), "");
  EXPECT_EQ(waits(queue), "2 s: answer 1 no: no answer from rtpu spare\n");
}

}  // namespace
}  // namespace chimera::subsystem
