// SPDX-License-Identifier: Apache-2.0
// Tests of tasks that share a resource, and of tasks whose device is not ready at once, through the whole Subsystem.
#include <gtest/gtest.h>

#include "chimera/subsystem/testing/test_world.h"

namespace chimera::subsystem {
namespace {

class SubsystemRivals : public ::testing::Test, public TestWorld {
 protected:
  /// All tasks are brought up except reserve: pid has its device.
  std::string start_without_reserve() {
    std::string told = step(remembered);
    step(RtpuUp{kServo, 1});
    step(RtpuUp{kSpare, 1});
    told += step(InventoryComplete{});
    for (TaskId task : {kArm, kTraj, kPid}) told += report(task, State::kOff);
    for (TaskId task : {kArm, kTraj, kPid}) told += report(task, State::kOn);
    return told;
  }
};

TEST_F(SubsystemRivals, TheStartLeavesOutATaskWhoseResourceIsTaken) {
  make_rivals();
  const std::string told = start_without_reserve();
  EXPECT_EQ(told.find("reserve"), std::string::npos) << told;
  EXPECT_NE(told.find("started: arm traj pid are ON"), std::string::npos) << told;
  EXPECT_TRUE(subsystem->is_settled());
}

TEST_F(SubsystemRivals, SpawnAndOnAreRefusedWithTheWayToIt) {
  make_rivals();
  start_without_reserve();
  const std::string why = "reserve has the resource 'tty0' of pid, which is ON; type `chimera switch careful`\n";
  EXPECT_EQ(command(Signal::kSpawn, {kReserve}), "answer 1 no: " + why);
  EXPECT_EQ(command(Signal::kOn, {kReserve}), "answer 2 no: " + why);
  spec.sets = {};
  command(Signal::kOff, {kPid});
  report(kPid, State::kOff);
  EXPECT_EQ(command(Signal::kSpawn, {kReserve}),
            "answer 4 no: reserve has the resource 'tty0' of pid, which is OFF; type `chimera kill pid`, then "
            "`chimera spawn reserve`\n");
  command(Signal::kKill, {kPid});
  report(kPid, State::kNotCreated);
  EXPECT_EQ(command(Signal::kSpawn, {kReserve}), "goal reserve 1\nsend spare: spawn reserve\n");
}

TEST_F(SubsystemRivals, AGoalWaitsForTheKillOfItsRivalAtMostTenSeconds) {
  make_rivals();
  start_without_reserve();
  die(kServo);  // while it is dead, a switch creates reserve
  seen(kReserve, State::kOff);
  step(RtpuUp{kServo, 2});
  EXPECT_EQ(report(kArm, State::kOff), "goal arm 2\n");
  EXPECT_EQ(seen(kReserve, State::kNotCreated), "send servo: spawn pid\n");
  die(kServo, 2);
  seen(kReserve, State::kOff);
  step(RtpuUp{kServo, 3});
  report(kArm, State::kOff);
  EXPECT_EQ(subsystem->next_due(), now + seconds(10));
  now = now + seconds(10);
  const std::string told = step(Tick{});
  EXPECT_NE(told.find("refused: pid has the resource 'tty0' of reserve, which is OFF"), std::string::npos) << told;
}

TEST_F(SubsystemRivals, AStandbyThatHasTakenOverKeepsTheResource) {
  make_standby();
  start_without_reserve();
  die(kServo);
  seen(kReserve, State::kOff);
  seen(kReserve, State::kOn);
  step(RtpuUp{kServo, 2});
  const std::string told = report(kArm, State::kOff);
  EXPECT_NE(told.find("note: pid stays NOT-CREATED: reserve has its resource"), std::string::npos) << told;
  EXPECT_EQ(subsystem->state(kPid), State::kNotCreated);
  EXPECT_EQ(told.find("spawn pid"), std::string::npos) << told;
}

TEST_F(SubsystemRivals, AfterTwoDeathsOnlyTheRivalThatWasOnLastComesBack) {
  make_standby();
  start_without_reserve();
  die(kServo);
  seen(kReserve, State::kOn);
  const std::string told = step(RtpuDown{kSpare, 1, "ended by signal 9 (SIGKILL)"});
  EXPECT_NE(told.find("goal reserve 3"), std::string::npos) << told;
  EXPECT_NE(told.find("goal pid 0"), std::string::npos) << told;
}

TEST_F(SubsystemRivals, OnIsAskedAgainUntilTheDeviceIsReady) {
  start();
  command(Signal::kOff, {kArm, kTraj, kPid});
  for (TaskId task : {kPid, kTraj, kArm}) report(task, State::kOff);
  command(Signal::kOn, {kArm, kTraj, kPid});
  EXPECT_EQ(refuse(kArm, Refusal::kNotYet), "") << "after a period";
  EXPECT_EQ(subsystem->next_due(), now + milliseconds(1));
  now = now + milliseconds(1);
  EXPECT_EQ(step(Tick{}), "send servo: on arm\n");
  EXPECT_EQ(report(kArm, State::kOn), "send spare: on traj\n");
  report(kTraj, State::kOn);
  const std::string end = report(kPid, State::kOn);
  EXPECT_NE(end.find("answer 2 yes"), std::string::npos) << end;
}

TEST_F(SubsystemRivals, AListGoesOnBehindATaskThatWasNotReady) {
  start();
  command(Signal::kOff, {kArm, kPid});
  for (TaskId task : {kPid, kArm}) report(task, State::kOff);
  EXPECT_NE(command(Signal::kOn, {kArm, kPid}).find("send servo: on arm pid"), std::string::npos);
  EXPECT_EQ(refuse(kArm, Refusal::kNotYet), "");
  EXPECT_EQ(refuse(kPid, Refusal::kNone), "");
  now = now + milliseconds(1);
  EXPECT_EQ(step(Tick{}), "send servo: on arm pid\n");
}

TEST_F(SubsystemRivals, ADeviceThatIsNeverReadyHasItsOff) {
  start();
  command(Signal::kOff, {kArm, kTraj, kPid});
  for (TaskId task : {kPid, kTraj, kArm}) report(task, State::kOff);
  command(Signal::kOn, {kArm, kTraj, kPid});
  now = now + seconds(10);
  EXPECT_EQ(refuse(kArm, Refusal::kNotYet), "send servo: off arm\n");
  const std::string end = report(kArm, State::kOff);
  EXPECT_NE(end.find("answer 2 no: arm: on: it is not ready yet"), std::string::npos) << end;
}

TEST_F(SubsystemRivals, OffTakesBackAnOnThatHasBegun) {
  start();
  command(Signal::kOff, {kArm, kTraj, kPid});
  for (TaskId task : {kPid, kTraj, kArm}) report(task, State::kOff);
  command(Signal::kOn, {kArm, kTraj, kPid});
  refuse(kArm, Refusal::kNotYet);
  const std::string told = command(Signal::kOff, {kArm});
  EXPECT_NE(told.find("send servo: off arm"), std::string::npos) << told;
}

}  // namespace
}  // namespace chimera::subsystem
