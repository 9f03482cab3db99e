// SPDX-License-Identifier: Apache-2.0
#include "chimera/subsystem/subsystem.h"

#include <gtest/gtest.h>

#include "chimera/subsystem/testing/test_world.h"

namespace chimera::subsystem {
namespace {

class StartTest : public ::testing::Test, public TestWorld {};
class SubsystemTest : public ::testing::Test, public TestWorld {
 protected:
  SubsystemTest() { start(); }
};

TEST_F(StartTest, RemembersItsGoalsFirst) {
  EXPECT_EQ(step(remembered), "goal arm 3\ngoal pid 3\ngoal traj 3\ngoal reserve 1\nremember started\n");
}

TEST_F(StartTest, SpawnsInTheOrderOfConstantsAsRtpusComeUp) {
  step(remembered);
  EXPECT_EQ(step(RtpuUp{kServo, 1}), "") << "not before the inventory is complete";
  EXPECT_EQ(step(InventoryComplete{}), "send servo: spawn arm\n");
  EXPECT_EQ(step(RtpuUp{kSpare, 1}), "send spare: spawn traj\n");
  EXPECT_EQ(report(kArm, State::kOff), "goal arm 2\nsend servo: spawn pid\nsend spare: spawn reserve\n");
}

TEST_F(StartTest, TurnsTheStartSetOnRunByRunInItsOrder) {
  step(remembered);
  step(RtpuUp{kServo, 1});
  step(RtpuUp{kSpare, 1});
  step(InventoryComplete{});
  for (TaskId task : {kArm, kTraj, kPid}) report(task, State::kOff);
  EXPECT_EQ(report(kReserve, State::kOff), "goal reserve 0\nsend servo: on arm\n");
  EXPECT_EQ(report(kArm, State::kOn), "send spare: on traj\n");
  EXPECT_EQ(report(kTraj, State::kOn), "send servo: on pid\n");
  EXPECT_FALSE(subsystem->is_settled());
  EXPECT_EQ(report(kPid, State::kOn), "goal arm 0\ngoal traj 0\ngoal pid 0\nstarted: arm traj pid are ON\n");
  EXPECT_TRUE(subsystem->is_settled());
}

TEST_F(StartTest, AFaultyInitGivesItsGoalsUpAndTheRestIsRefusedWhenItIsNoLegalSet) {
  step(remembered);
  step(RtpuUp{kServo, 1});
  step(RtpuUp{kSpare, 1});
  step(InventoryComplete{});
  for (TaskId task : {kArm, kPid, kReserve}) report(task, State::kOff);
  EXPECT_EQ(report(kTraj, State::kNotCreated, "no file"),
            "fault: spawn: traj: no file\ngoal traj 0\n"
            "refused: ref would have no producer; the smallest legal set is: arm pid traj\ngoal arm 0\ngoal pid 0\n");
  EXPECT_TRUE(subsystem->is_settled());
}

TEST_F(StartTest, AnRtpuThatNeverServesIsNotWaitedForForever) {
  step(remembered);
  step(RtpuUp{kServo, 1});
  step(InventoryComplete{});
  report(kArm, State::kOff);
  report(kPid, State::kOff);
  EXPECT_EQ(subsystem->next_due(), now + seconds(10));
  now += seconds(10);
  EXPECT_EQ(step(Tick{}),
            "refused: no answer from rtpu spare\ngoal traj 0\nrefused: no answer from rtpu spare\ngoal reserve 0\n"
            "refused: ref would have no producer; the smallest legal set is: arm pid traj\ngoal arm 0\ngoal pid 0\n");
}

TEST_F(SubsystemTest, ATaskInTheWantedStateIsDoneAlready) {
  EXPECT_EQ(command(Signal::kOn, {kArm, kPid}), "answer 1 yes arm ON>ON already pid ON>ON already\n");
  EXPECT_EQ(command(Signal::kOff, {kReserve}), "answer 2 yes reserve OFF>OFF already\n");
  EXPECT_EQ(command(Signal::kOff, {kPid, kReserve}), "send servo: off pid\n");
  EXPECT_EQ(report(kPid, State::kOff), "answer 3 yes reserve OFF>OFF already pid ON>OFF\n");
  EXPECT_EQ(command(Signal::kOn, {kPid, kArm}), "goal pid 2\nsend servo: on pid\n");
  EXPECT_EQ(report(kPid, State::kOn), "goal pid 0\nanswer 4 yes pid OFF>ON arm ON>ON already\n");
}

TEST_F(SubsystemTest, ARefusalHasARemedyForTheWholeList) {
  command(Signal::kKill, {kReserve});
  report(kReserve, State::kNotCreated);
  for (std::uint32_t i = 1; i <= 3; ++i) {
    die(kServo, i);
    step(RtpuUp{kServo, i + 1});
  }
  die(kServo, 4);
  EXPECT_EQ(command(Signal::kOn, {kArm, kPid, kTraj, kReserve}),
            "answer 2 no: arm is in state ERROR, where on is not legal; type `chimera spawn reserve`, "
            "`chimera clear arm pid`, then `chimera on arm pid reserve`\n");
}

TEST_F(SubsystemTest, AnInitThatIsUnderWayIsWaitedFor) {
  command(Signal::kKill, {kReserve});
  report(kReserve, State::kNotCreated);
  EXPECT_EQ(command(Signal::kSpawn, {kReserve}), "goal reserve 1\nsend spare: spawn reserve\n");
  seen(kReserve, State::kNotCreated, true);
  now += seconds(2);
  EXPECT_EQ(step(Tick{}), "");
  now += seconds(1);
  EXPECT_EQ(report(kReserve, State::kOff), "goal reserve 0\nanswer 2 yes reserve NOT-CREATED>OFF\n");
}

TEST_F(SubsystemTest, AKillThatIsUnderWayIsWaitedForNoLongerThanItsLimit) {
  EXPECT_EQ(command(Signal::kKill, {kReserve}), "send spare: kill reserve\n");
  seen(kReserve, State::kOff, true);
  now += seconds(2);
  EXPECT_EQ(step(Tick{}), "");
  EXPECT_EQ(subsystem->next_due(), seconds(100) + kKillLimit);
  now = subsystem->next_due();
  EXPECT_EQ(step(Tick{}), "answer 1 no: no answer from rtpu spare reserve OFF>OFF\n");
  EXPECT_EQ(subsystem->next_due(), kNever);
  EXPECT_EQ(report(kReserve, State::kNotCreated), "") << "it ends later nevertheless";
}

TEST_F(SubsystemTest, AKillWaitsForAnInitNoLongerThanItsLimitEither) {
  command(Signal::kKill, {kReserve});
  report(kReserve, State::kNotCreated);
  command(Signal::kSpawn, {kReserve});
  seen(kReserve, State::kNotCreated, true);
  now += seconds(10);
  (void)step(Tick{});
  (void)command(Signal::kKill, {kReserve});
  EXPECT_LE(subsystem->next_due(), now + kKillLimit);
  now += kKillLimit;
  const std::string said = step(Tick{});
  EXPECT_NE(said.find("answer 3 no: no answer from rtpu spare"), std::string::npos) << said;
}

TEST_F(SubsystemTest, OnOfTheTasksOfAnIllegalSetIsAccepted) {
  command(Signal::kOff, {kTraj, kPid});
  for (TaskId task : {kPid, kTraj}) report(task, State::kOff);
  const auto tasks_of = [this](TaskId task) {
    std::vector<Action> actions;
    subsystem->step(Commanded{++commands, Signal::kOn, {task}}, now, actions);
    const auto* answer = std::get_if<CommandAnswer>(&actions.back());
    EXPECT_TRUE(answer != nullptr && answer->refusal.kind == RefusalKind::kSet) << lines(actions);
    return answer == nullptr ? std::vector<TaskId>() : answer->refusal.tasks;
  };
  const std::vector<TaskId> tasks = tasks_of(kPid);
  EXPECT_EQ(tasks, (std::vector{kTraj, kPid})) << "arm is ON";
  EXPECT_EQ(command(Signal::kOn, tasks), "goal traj 2\ngoal pid 2\nsend spare: on traj\n");
  report(kTraj, State::kOn);
  report(kPid, State::kOn);
  EXPECT_EQ(tasks_of(kReserve), std::vector<TaskId>()) << "tau would have two producers";
}

TEST_F(SubsystemTest, ARequestOfATaskIsJudgedAndItsRefusalReported) {
  EXPECT_EQ(step(Requested{kReserve, Signal::kOn, kTraj}),
            "refused: on sent by traj: tau would have two producers: pid and reserve\n");
}

TEST_F(SubsystemTest, ADeadRtpuComesBackWithItsTasksOn) {
  EXPECT_EQ(die(kServo),
            "rtpu-ended: servo ended by signal 11 (SIGSEGV) in pid.cycle\n"
            "goal arm 3\ngoal pid 3\nrestart servo\nstart servo\nhandled servo 1\n"
            "rtpu-restarted: servo is restarted, 1 of at most 3 times in 10 s\n");
  EXPECT_EQ(subsystem->state(kPid), State::kError);
  EXPECT_EQ(step(RtpuUp{kServo, 2}), "send servo: spawn arm\n");
  EXPECT_EQ(report(kArm, State::kOff), "goal arm 2\nsend servo: spawn pid\n");
  EXPECT_EQ(report(kPid, State::kOff), "goal pid 2\nsend servo: on arm pid\n");
  report(kArm, State::kOn);
  EXPECT_EQ(report(kPid, State::kOn), "goal arm 0\ngoal pid 0\nstarted: arm pid are ON\n");
}

TEST_F(SubsystemTest, ATaskWhoseStandbyIsOnComesBackOff) {
  const StandbySpec pair[] = {{kPid, kReserve}};
  spec.standbys = pair;
  die(kServo);
  seen(kReserve, State::kOn);  // by itself
  step(RtpuUp{kServo, 2});
  EXPECT_EQ(report(kArm, State::kOff), "goal arm 2\nsend servo: spawn pid\n");
  EXPECT_EQ(report(kPid, State::kOff), "goal pid 2\ngoal pid 0\nsend servo: on arm\n");
  EXPECT_EQ(report(kArm, State::kOn), "goal arm 0\nstarted: arm is ON\n");
}

// Both rtpus die one after the other. Only the task that had taken over comes back ON.
TEST_F(SubsystemTest, AfterTwoDeathsTheStandbyThatWasOnComesBackOn) {
  const StandbySpec pair[] = {{kPid, kReserve}};
  spec.standbys = pair;
  die(kServo);
  seen(kReserve, State::kOn);  // by itself
  EXPECT_EQ(die(kSpare),
            "rtpu-ended: spare ended by signal 11 (SIGSEGV) in pid.cycle\n"
            "goal traj 3\ngoal reserve 3\ngoal pid 1\nrestart spare\nstart spare\nhandled spare 1\n"
            "rtpu-restarted: spare is restarted, 1 of at most 3 times in 10 s\n");
  step(RtpuUp{kServo, 2});
  step(RtpuUp{kSpare, 2});
  for (TaskId task : {kArm, kTraj, kPid}) report(task, State::kOff);
  EXPECT_EQ(report(kReserve, State::kOff), "goal reserve 2\nsend servo: on arm\n");
  EXPECT_EQ(report(kArm, State::kOn), "send spare: on traj reserve\n");
}

TEST_F(SubsystemTest, ATaskWhoseStandbyDidNotComeIsTurnedOnAgain) {
  const StandbySpec pair[] = {{kPid, kReserve}};
  spec.standbys = pair;
  die(kServo);
  seen(kReserve, State::kError);  // its on failed
  step(RtpuUp{kServo, 2});
  report(kArm, State::kOff);
  EXPECT_EQ(report(kPid, State::kOff), "goal pid 2\nsend servo: on arm pid\n");
}

TEST_F(SubsystemTest, ACommandToADeadRtpuIsAnsweredWithTheCause) {
  command(Signal::kOff, {kPid});
  EXPECT_EQ(die(kServo),
            "rtpu-ended: servo ended by signal 11 (SIGSEGV) in pid.cycle\n"
            "goal arm 3\ngoal pid 1\nrestart servo\nstart servo\nhandled servo 1\n"
            "rtpu-restarted: servo is restarted, 1 of at most 3 times in 10 s\n"
            "answer 1 no: servo ended by signal 11 (SIGSEGV) in pid.cycle pid ERROR>ERROR\n");
}

TEST_F(SubsystemTest, AfterThreeRestartsInTenSecondsItGivesUpUntilAPersonStartsIt) {
  for (std::uint32_t i = 1; i <= 3; ++i) {
    die(kSpare, i);
    step(RtpuUp{kSpare, i + 1});
  }
  const std::string why =
      ": spare ended 4 times in 10 s and is not restarted: it ended by signal 11 (SIGSEGV) in pid.cycle; type `chimera "
      "clear traj reserve`, then `chimera on traj`\n";
  EXPECT_EQ(die(kSpare, 4),
            "rtpu-ended: spare ended by signal 11 (SIGSEGV) in pid.cycle\n"
            "refused" + why + "goal traj 0\nrefused" + why + "goal reserve 0\nrtpu-given-up" + why +
                "not-off: spare ended by signal 11 (SIGSEGV) in pid.cycle, is not restarted, and this task was not "
                "turned off: its hardware may not be off\nhandled spare 4\n");
  EXPECT_EQ(subsystem->state(kTraj), State::kError);
  EXPECT_EQ(command(Signal::kOn, {kTraj}),
            "answer 1 no: traj is in state ERROR, where on is not legal; type `chimera clear traj`, then `chimera on "
            "traj`\n");
  EXPECT_EQ(command(Signal::kKill, {kReserve}), "goal reserve 4\nanswer 2 yes reserve ERROR>NOT-CREATED\n");
  EXPECT_EQ(command(Signal::kClear, {kTraj}), "goal traj 1\nrestart spare\nstart spare\n");
  EXPECT_EQ(step(RtpuUp{kSpare, 5}), "goal reserve 0\nsend spare: spawn traj\n");
  EXPECT_EQ(report(kTraj, State::kOff), "goal traj 0\nanswer 3 yes traj ERROR>OFF\n");
}

TEST_F(SubsystemTest, ClearBringsBackLostTasksButNotKilledOnes) {
  command(Signal::kKill, {kReserve});
  report(kReserve, State::kNotCreated);
  for (std::uint32_t i = 1; i <= 4; ++i) {
    seen(kArm, State::kOn);
    seen(kPid, State::kOn);
    die(kServo, i);
    if (i < 4) step(RtpuUp{kServo, i + 1});
  }
  ASSERT_TRUE(subsystem->is_given_up(kServo));
  EXPECT_EQ(subsystem->way_back(kServo), "`chimera clear arm pid`, then `chimera on arm pid`");
  EXPECT_EQ(command(Signal::kClear, {kArm}), "goal arm 1\ngoal pid 1\nrestart servo\nstart servo\n");
  EXPECT_FALSE(subsystem->is_given_up(kServo));
  EXPECT_EQ(subsystem->state(kReserve), State::kNotCreated);
}

TEST_F(SubsystemTest, ANewManagerNamesTheRemedyForAGivenUpRtpu) {
  start();
  remembered.started = true;
  remembered.handled[kServo.index] = 4;
  rebirth();
  die(kServo, 4);
  EXPECT_TRUE(subsystem->is_given_up(kServo));
  EXPECT_EQ(subsystem->way_back(kServo), "`chimera spawn arm pid`");
}

TEST_F(SubsystemTest, SaysWhichInputHasNoRunningProducer) {
  EXPECT_EQ(subsystem->missing(), "");
  command(Signal::kOff, {kTraj});
  report(kTraj, State::kOff);
  EXPECT_EQ(subsystem->missing(), "ref (traj is OFF)");
}

TEST_F(SubsystemTest, TheNextManagerGoesOnWithATransaction) {
  command(Signal::kOff, {kArm, kTraj, kPid});
  for (TaskId task : {kPid, kTraj, kArm}) report(task, State::kOff);
  command(Signal::kOn, {kArm, kTraj, kPid});
  report(kArm, State::kOn);
  now += seconds(1);
  EXPECT_EQ(rebirth(), "");
  for (TaskId task : {kArm, kPid, kTraj, kReserve}) seen(task, states[task.index]);
  EXPECT_EQ(command(Signal::kOff, {kReserve}), "") << "a command waits for the inventory";
  step(RtpuUp{kServo, 1});
  step(RtpuUp{kSpare, 1});
  EXPECT_EQ(step(InventoryComplete{}), "answer 3 yes reserve OFF>OFF already\nsend spare: on traj\n");
  report(kTraj, State::kOn);
  EXPECT_EQ(report(kPid, State::kOn), "goal arm 0\ngoal traj 0\ngoal pid 0\nstarted: arm traj pid are ON\n");
}

TEST_F(SubsystemTest, TheNextManagerHandlesADeathWithoutAManager) {
  rebirth();
  for (TaskId task : {kArm, kTraj, kPid}) seen(task, State::kOn);
  seen(kReserve, State::kOff);
  step(RtpuUp{kSpare, 1});
  EXPECT_EQ(die(kServo),
            "rtpu-ended: servo ended by signal 11 (SIGSEGV) in pid.cycle\n"
            "goal arm 3\ngoal pid 3\nrestart servo\nstart servo\nhandled servo 1\n"
            "rtpu-restarted: servo is restarted, 1 of at most 3 times in 10 s\n");
  rebirth();
  for (TaskId task : {kArm, kPid}) seen(task, State::kOn);
  EXPECT_EQ(die(kServo), "start servo\n") << "handled, but a task of it has goals";
}

}  // namespace
}  // namespace chimera::subsystem
