// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/on_transaction.h"

#include <gtest/gtest.h>

#include "chimera/subsystem/testing/test_parts.h"

namespace chimera::subsystem {
namespace {

const SignalRefusal kNoSensor{RefusalKind::kFault, "no sensor", {}};

class OnTransactionTest : public ::testing::Test, public TestParts {
 protected:
  /// A request of a person.
  void begin(std::vector<TaskId> tasks) { transaction.begin({7, std::move(tasks), TaskId{}, false}); }
  /// The rtpu reports, and the next signals are sent.
  std::string report(TaskId task, State after, SignalRefusal why = {}) {
    transaction.on_result(reported(task, after, std::move(why)));
    (void)transaction.advance();
    return taken();
  }
  std::string advance() {
    (void)transaction.advance();
    return taken();
  }
};

TEST_F(OnTransactionTest, SendsTheTasksInDataFlowOrderOneRtpuAtATime) {
  begin({kPid, kTraj, kArm});
  EXPECT_TRUE(transaction.is_under_way());
  EXPECT_TRUE(transaction.has(kTraj));
  EXPECT_FALSE(transaction.has(kReserve));
  EXPECT_EQ(taken(), "goal arm 2\ngoal traj 2\ngoal pid 2\n");
  EXPECT_EQ(advance(), "send servo: on arm\n");
  EXPECT_FALSE(transaction.advance()) << "a report is awaited";
  EXPECT_EQ(report(kArm, State::kOn), "send spare: on traj\n");
  EXPECT_EQ(report(kTraj, State::kOn), "send servo: on pid\n");
  EXPECT_EQ(report(kPid, State::kOn),
            "goal arm 0\ngoal traj 0\ngoal pid 0\nanswer 7 yes arm OFF>ON traj OFF>ON pid OFF>ON\n");
  EXPECT_FALSE(transaction.is_under_way());
  EXPECT_FALSE(transaction.has(kTraj));
}

TEST_F(OnTransactionTest, SendsNeighboursOfOneRtpuInOneList) {
  are_on({kTraj});
  begin({kArm, kPid});
  (void)taken();
  EXPECT_EQ(advance(), "send servo: on arm pid\n");
  EXPECT_EQ(report(kArm, State::kOn), "");
  EXPECT_EQ(report(kPid, State::kOn), "goal arm 0\ngoal pid 0\nanswer 7 yes arm OFF>ON pid OFF>ON\n");
}

TEST_F(OnTransactionTest, DoesNotBeginWithATaskInAWrongState) {
  is(kTraj, State::kError);
  begin({kTraj});
  EXPECT_EQ(taken(), "answer 7 no: traj is in state ERROR, where on is not legal; type `chimera clear traj`, then "
                     "`chimera on traj`\n");
  EXPECT_FALSE(transaction.is_under_way());
}

TEST_F(OnTransactionTest, SendsNothingOfAnIllegalSet) {
  are_on({kArm, kTraj, kPid});
  begin({kReserve});
  EXPECT_EQ(taken(), "");
  EXPECT_EQ(advance(), "answer 7 no: tau would have two producers: pid and reserve\n");
  EXPECT_FALSE(transaction.is_under_way());
}

TEST_F(OnTransactionTest, SendsNothingOfASetThatTakesTooMuchOfACpu) {
  set_budget(kArm, microseconds(500));
  set_budget(kPid, microseconds(440));
  set_budget(kTraj, microseconds(440));
  are_on({kArm, kTraj});
  begin({kPid});
  EXPECT_EQ(advance(), "answer 7 no: the budgets would take 0.940 of CPU 0; expected at most 0.93; turn other tasks of "
                       "that CPU OFF\n");
}

TEST_F(OnTransactionTest, AFailureTurnsOffItsTasksInReverse) {
  begin({kPid, kTraj, kArm});
  (void)advance();
  (void)report(kArm, State::kOn);
  (void)report(kTraj, State::kOn);
  EXPECT_EQ(report(kPid, State::kOff, kNoSensor), "send spare: off traj\nsend servo: off arm\n")
      << "pid is OFF already";
  EXPECT_EQ(report(kArm, State::kOff), "");
  EXPECT_EQ(report(kTraj, State::kOff), "goal arm 0\ngoal traj 0\ngoal pid 0\nanswer 7 no: pid: no sensor\n");
}

TEST_F(OnTransactionTest, AFailureLeavesTasksOnThatWereOnBefore) {
  are_on({kTraj, kArm});
  begin({kPid, kArm});
  EXPECT_EQ(taken(), "goal pid 2\n");
  EXPECT_FALSE(transaction.has(kArm));
  EXPECT_EQ(advance(), "send servo: on pid\n");
  EXPECT_EQ(report(kPid, State::kOff, kNoSensor), "goal pid 0\nanswer 7 no: pid: no sensor\n");
}

TEST_F(OnTransactionTest, FailsWhenAMemberLeavesOnByItself) {
  begin({kPid, kTraj, kArm});
  (void)advance();
  (void)report(kArm, State::kOn);
  is(kArm, State::kError);
  transaction.on_task_seen(kArm);
  EXPECT_EQ(report(kTraj, State::kOn), "send spare: off traj\n") << "and no off to a task in ERROR";
  EXPECT_EQ(report(kTraj, State::kOff),
            "goal arm 0\ngoal traj 0\ngoal pid 0\nanswer 7 no: arm: went from ON to ERROR\n");
}

TEST_F(OnTransactionTest, LeavesATaskThatIsWithdrawnToTheCommandThatDidIt) {
  begin({kPid, kTraj, kArm});
  (void)advance();
  (void)report(kArm, State::kOn);
  EXPECT_FALSE(transaction.withdraw(kReserve, Signal::kOff)) << "no member";
  EXPECT_TRUE(transaction.withdraw(kArm, Signal::kOff));
  EXPECT_FALSE(transaction.withdraw(kArm, Signal::kOff)) << "it was withdrawn already";
  EXPECT_EQ(report(kTraj, State::kOn), "send spare: off traj\n") << "and none to arm";
  EXPECT_EQ(report(kTraj, State::kOff),
            "goal arm 0\ngoal traj 0\ngoal pid 0\nanswer 7 no: arm: off was asked for in between\n");
}

TEST_F(OnTransactionTest, SendsNothingToAnRtpuThatEnded) {
  begin({kPid, kTraj, kArm});
  (void)advance();
  (void)report(kArm, State::kOn);
  (void)report(kTraj, State::kOn);
  state.observed.down(kServo, 1);
  transaction.on_rtpu_down(kServo, "ended by signal 9");
  EXPECT_EQ(advance(), "send spare: off traj\n");
  EXPECT_EQ(report(kTraj, State::kOff),
            "goal arm 0\ngoal traj 0\ngoal pid 0\nanswer 7 no: arm: servo ended by signal 9\n");
}

TEST_F(OnTransactionTest, KeepsItsGoalsAfterAnRtpuEnded) {
  are_on({kTraj});
  for (TaskId task : {kArm, kPid}) goals.add(task, kGoalOn);
  transaction.begin({0, {kArm, kPid}, TaskId{}, true});
  (void)advance();
  state.observed.down(kServo, 1);
  transaction.on_rtpu_down(kServo, "ended by signal 9");
  EXPECT_EQ(advance(), "");
  EXPECT_FALSE(transaction.is_under_way());
  EXPECT_TRUE(goals.has(kArm, kGoalOn) && goals.has(kPid, kGoalOn));
}

TEST_F(OnTransactionTest, ResumesTheGoalsOfAnEarlierManager) {
  are_on({kTraj, kArm});
  for (TaskId task : {kArm, kPid}) goals.add(task, kGoalOn);
  transaction.begin({0, {kArm, kPid}, TaskId{}, true});
  (void)taken();
  EXPECT_EQ(advance(), "send servo: on pid\n");
  EXPECT_EQ(report(kPid, State::kOff, kNoSensor), "send servo: off arm\n")
      << "the earlier manager turned arm ON";
  EXPECT_EQ(report(kArm, State::kOff), "refused: pid: no sensor\ngoal arm 0\ngoal pid 0\n");
}

TEST_F(OnTransactionTest, ReportsTheSenderOfASignal) {
  transaction.begin({0, {kTraj}, kArm, false});
  (void)advance();
  EXPECT_EQ(report(kTraj, State::kOn), "goal traj 0\nsignal: on sent by arm: traj is ON\n");
  transaction.begin({0, {kTraj}, kArm, false});
  EXPECT_EQ(taken(), "refused: on sent by arm: traj is in state ON, where on is not legal\n");
}

}  // namespace
}  // namespace chimera::subsystem
