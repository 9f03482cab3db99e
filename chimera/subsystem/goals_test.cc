// SPDX-License-Identifier: Apache-2.0
// Tests of goals, and of the commands that take goals back, through the whole Subsystem.
#include "chimera/subsystem/goals.h"

#include <gtest/gtest.h>

#include "chimera/subsystem/testing/test_world.h"

namespace chimera::subsystem {
namespace {

class GoalsTest : public ::testing::Test, public TestWorld {
 protected:
  GoalsTest() { start(); }
  void all_off() {
    command(Signal::kOff, {kArm, kTraj, kPid});
    for (TaskId task : {kPid, kTraj, kArm}) report(task, State::kOff);
  }
};

TEST_F(GoalsTest, OffOfATaskThatWaitsForOnFailsTheTransaction) {
  all_off();
  command(Signal::kOn, {kArm, kTraj, kPid});
  EXPECT_EQ(command(Signal::kOff, {kPid}), "goal pid 0\nanswer 3 yes pid OFF>OFF\n");
  EXPECT_EQ(report(kArm, State::kOn), "send servo: off arm\n");
  EXPECT_EQ(report(kArm, State::kOff),
            "goal arm 0\ngoal traj 0\nanswer 2 no: pid: off was asked for in between\n");
}

TEST_F(GoalsTest, KillWaitsForTheSpawnThatIsUnderWayAndTakesItsGoalBack) {
  command(Signal::kKill, {kReserve});
  report(kReserve, State::kNotCreated);
  command(Signal::kSpawn, {kReserve});
  const Reported spawn = sent[kReserve.index];
  EXPECT_EQ(command(Signal::kKill, {kReserve}), "goal reserve 0\nanswer 2 yes reserve NOT-CREATED>NOT-CREATED\n");
  seen(kReserve, State::kOff);
  EXPECT_EQ(step(Reported{spawn.command, kReserve, Signal::kSpawn, true, Refusal::kNone, State::kNotCreated,
                          State::kOff, {}}),
            "send spare: kill reserve\n");
  EXPECT_EQ(report(kReserve, State::kNotCreated), "answer 3 yes reserve OFF>NOT-CREATED\n");
}

TEST_F(GoalsTest, ACommandForATaskThatIsBroughtUpWaitsAndIsFulfilledByIt) {
  die(kServo);
  EXPECT_EQ(command(Signal::kOn, {kArm, kPid}), "");
  step(RtpuUp{kServo, 2});
  report(kArm, State::kOff);
  report(kPid, State::kOff);
  report(kArm, State::kOn);
  EXPECT_EQ(report(kPid, State::kOn),
            "goal arm 0\ngoal pid 0\nstarted: arm pid are ON\nanswer 1 yes arm OFF>ON pid OFF>ON\n");
}

// docs/formats/control.md, `signal`: only `on` is one transaction over all rtpus.
TEST_F(GoalsTest, ARefusedOffOfAListDoesNotUndoOtherTasks) {
  const std::string asked = command(Signal::kOff, {kArm, kTraj});
  EXPECT_NE(asked.find("send servo: off arm\n"), std::string::npos) << asked;
  EXPECT_NE(asked.find("send spare: off traj\n"), std::string::npos) << asked;
  EXPECT_EQ(report(kTraj, State::kOff), "");
  EXPECT_EQ(refuse(kArm, Refusal::kFault, "the brake does not hold"),
            "answer 1 no: off: arm: the brake does not hold traj ON>OFF arm ON>ON\n");
  EXPECT_EQ(states[kTraj.index], State::kOff);
}

TEST_F(GoalsTest, OffTakesTheGoalOnBackWhileTheProcessIsRestarted) {
  die(kServo);
  EXPECT_EQ(command(Signal::kOff, {kArm, kPid}),
            "goal pid 1\ngoal arm 1\nanswer 1 yes pid ERROR>ERROR arm ERROR>ERROR\n");
  step(RtpuUp{kServo, 2});
  report(kArm, State::kOff);
  EXPECT_EQ(report(kPid, State::kOff), "goal pid 0\n");
  EXPECT_TRUE(subsystem->is_settled());
}

TEST_F(GoalsTest, ATaskWithAPendingKillDoesNotComeBack) {
  command(Signal::kKill, {kReserve});
  EXPECT_EQ(die(kSpare),
            "rtpu-ended: spare ended by signal 11 (SIGSEGV) in pid.cycle\n"
            "goal traj 3\nrestart spare\nstart spare\nhandled spare 1\n"
            "rtpu-restarted: spare is restarted, 1 of at most 3 times in 10 s\n"
            "answer 1 no: spare ended by signal 11 (SIGSEGV) in pid.cycle reserve ERROR>ERROR\n");
  step(RtpuUp{kSpare, 2});
  EXPECT_EQ(subsystem->state(kReserve), State::kNotCreated);
}

TEST_F(GoalsTest, AnInitThatEndsItsProcessIsNotTriedAgain) {
  command(Signal::kKill, {kReserve});
  report(kReserve, State::kNotCreated);
  command(Signal::kSpawn, {kReserve});
  const std::string said = die(kSpare);
  EXPECT_NE(said.find("goal reserve 0\n"), std::string::npos) << said;
  EXPECT_NE(said.find("answer 2 no: spare ended by signal 11 (SIGSEGV) in pid.cycle"), std::string::npos) << said;
  EXPECT_EQ(step(RtpuUp{kSpare, 2}), "send spare: spawn traj\n");
}

TEST_F(GoalsTest, GoalsOutliveADeathInTheMiddleOfTheirTransaction) {
  die(kServo);
  step(RtpuUp{kServo, 2});
  report(kArm, State::kOff);
  report(kPid, State::kOff);
  report(kArm, State::kOn);
  EXPECT_EQ(die(kServo, 2),
            "rtpu-ended: servo ended by signal 11 (SIGSEGV) in pid.cycle\n"
            "goal arm 3\ngoal pid 3\nrestart servo\nstart servo\nhandled servo 2\n"
            "rtpu-restarted: servo is restarted, 2 of at most 3 times in 10 s\n");
  step(RtpuUp{kServo, 3});
  report(kArm, State::kOff);
  EXPECT_EQ(report(kPid, State::kOff), "goal pid 2\nsend servo: on arm pid\n");
}

TEST_F(GoalsTest, AMuteRtpuIsNoAnswerAndItsTasksMayBeOn) {
  command(Signal::kOff, {kPid});
  report(kPid, State::kOff);
  now += seconds(1);
  rebirth();
  for (TaskId task : {kTraj, kReserve}) seen(task, states[task.index]);
  step(RtpuUp{kSpare, 1});
  step(InventoryComplete{});
  EXPECT_EQ(command(Signal::kOff, {kArm}), "");
  EXPECT_EQ(command(Signal::kOn, {kReserve}),
            "answer 3 no: tau would have two producers: pid and reserve\n");
  EXPECT_EQ(subsystem->next_due(), now + seconds(2));
  now += seconds(2);
  EXPECT_EQ(step(Tick{}), "answer 2 no: no answer from rtpu servo\n");
}

TEST_F(GoalsTest, KeepsARequestOnceAndIgnoresUnknownTasks) {
  command(Signal::kOff, {kPid});
  EXPECT_EQ(step(Requested{kReserve, Signal::kOn, kTraj}), "");
  EXPECT_EQ(step(Requested{kReserve, Signal::kOn, kTraj}), "");
  EXPECT_EQ(step(Requested{TaskId(99u), Signal::kOn, kTraj}), "");
  EXPECT_EQ(step(Requested{kReserve, Signal::kOn, TaskId(99u)}), "");
  report(kPid, State::kOff);
  EXPECT_EQ(report(kReserve, State::kOn), "goal reserve 0\nsignal: on sent by traj: reserve is ON\n");
}

}  // namespace
}  // namespace chimera::subsystem
