// SPDX-License-Identifier: Apache-2.0
// The effects of the actions of the step function; posts to rtpus that answer: manager_loop_test.cc.
#include "chimera/manager/act/step_runner.h"

#include <gtest/gtest.h>

#include "chimera/manager/testing/lone_state.h"

namespace chimera::manager {
namespace {

using subsystem::CommandAnswer;
using subsystem::kGoalOn;
using subsystem::kGoalSpawn;

class StepRunnerTest : public ::testing::Test, public LoneState {
 protected:
  StepRunnerTest() : ends_(*Channel::pair()), rtpu_links_(state()), runner_(state(), rtpu_links_, ends_.first) {}

  std::uint32_t goal(const char* name) { return state().own.block().view().goal(task(name)); }
  ManagerMemory& memory() { return state().own.block().memory(); }
  /// The index in each message that asks the keeper to start an rtpu.
  std::vector<std::uint32_t> started() {
    std::vector<std::uint32_t> indices;
    KeeperMessage message;
    for (int passed = -1; ends_.second.receive(bytes_of(message), passed) == Channel::Got::kMessage;) {
      EXPECT_EQ(message.kind, KeeperMessage::Kind::kStart);
      indices.push_back(message.index);
    }
    return indices;
  }
  /// Both rtpus have ended and are not started again: commands are answered at once.
  void end_all() {
    for (RtpuId rtpu : {RtpuId(0u), RtpuId(1u)}) runner_.step(subsystem::RtpuDown{rtpu, 1, "ended", true, true});
    runner_.step(subsystem::InventoryComplete{});
  }
  /// Appends "ID yes" or "ID no: why" to `answers_`.
  Answered note() {
    return [this](const CommandAnswer& answer) {
      const std::string end = answer.is_accepted() ? " yes" : " no: " + answer.refusal.text();
      answers_ += std::to_string(answer.id) + end + "\n";
    };
  }

  std::pair<Channel, Channel> ends_;
  RtpuLinks rtpu_links_;
  StepRunner runner_;
  std::string answers_;
};

TEST_F(StepRunnerTest, KeepsTheGoalsOfTheFirstStepInTheManagersBlock) {
  runner_.begin();
  for (const char* name : {"sensor", "filter", "law"}) EXPECT_EQ(goal(name), kGoalSpawn | kGoalOn) << name;
  EXPECT_EQ(memory().started, 1u);
  EXPECT_FALSE(state().logic.is_settled());
}

TEST_F(StepRunnerTest, ResumesTheGoalsThatAPredecessorLeft) {
  memory().started = 1;
  state().own.block().set_goal(task("law"), kGoalSpawn);
  runner_.begin();
  EXPECT_EQ(goal("law"), kGoalSpawn);
  EXPECT_EQ(goal("sensor"), 0u) << "nothing is asked for a second time";
}

TEST_F(StepRunnerTest, DoesNotRepeatTheReactionOfAPredecessorToADeath) {
  memory().started = 1;
  memory().handled[1] = 4;
  runner_.begin();
  const std::uint64_t last = state().log.last();
  runner_.step(subsystem::RtpuDown{RtpuId(1u), 4, "ended by signal 9 (SIGKILL)"});
  EXPECT_EQ(told(last), "");
  runner_.step(subsystem::RtpuDown{RtpuId(1u), 5, "ended by signal 9 (SIGKILL)"});
  EXPECT_NE(told(last), "");
}

TEST_F(StepRunnerTest, ForgetsTheStatesOfTasksWhenADeathIsHandled) {
  runner_.begin();
  for (const char* name : {"law", "sensor"}) state().own.block().set_status(task(name), {State::kOn});
  runner_.step(subsystem::RtpuDown{RtpuId(1u), 3, "ended by signal 9 (SIGKILL)"});
  EXPECT_EQ(state().own.block().view().status(task("law")).state, State::kNotCreated) << "it is a goal now";
  EXPECT_EQ(state().own.block().view().status(task("sensor")).state, State::kOn) << "of the other rtpu";
}

TEST_F(StepRunnerTest, AsksTheKeeperToStartAnRtpuAndRemembersThatAndWhen) {
  runner_.begin();
  const std::uint64_t last = state().log.last();
  const Nanoseconds before = now();
  runner_.step(subsystem::RtpuDown{RtpuId(1u), 3, "ended by signal 9 (SIGKILL)"});
  EXPECT_EQ(started(), std::vector<std::uint32_t>{1});
  EXPECT_EQ(memory().handled[1], 3u);
  EXPECT_EQ(memory().handled[0], 0u);
  Nanoseconds newest;
  for (const auto& instant : memory().restarts[1]) newest = std::max(newest, Nanoseconds{instant.load()});
  EXPECT_GE(newest, before);
  EXPECT_LE(newest, now());
  EXPECT_EQ(told(last),
            "rtpu-ended: spare ended by signal 9 (SIGKILL)\n"
            "rtpu-restarted: spare is restarted, 1 of at most 3 times in 10 s\n");
}

TEST_F(StepRunnerTest, CountsTheRestartsOfAPredecessor) {
  memory().started = 1;
  for (std::size_t i = 0; i < 3; ++i) memory().restarts[1][i] = now().count;
  state().own.block().set_goal(task("law"), kGoalSpawn);
  runner_.begin();
  runner_.step(subsystem::RtpuDown{RtpuId(1u), 3, "ended by signal 9 (SIGKILL)"});
  EXPECT_TRUE(started().empty()) << "three times in ten seconds are enough";
  EXPECT_TRUE(state().logic.is_given_up(RtpuId(1u)));
}

TEST_F(StepRunnerTest, StepsForEachEventInItsOrder) {
  runner_.begin();
  const std::uint64_t last = state().log.last();
  runner_.step(Events{subsystem::RtpuDown{RtpuId(1u), 1, "ended"}, subsystem::RtpuDown{RtpuId(0u), 1, "ended"}});
  EXPECT_EQ(started(), (std::vector<std::uint32_t>{1, 0}));
  EXPECT_EQ(told(last).find("rtpu-ended: spare ended\n"), 0u) << told(last);
}

TEST_F(StepRunnerTest, AnswersEachCommandOnceAndLogsItsWords) {
  memory().started = 1;
  runner_.begin();
  end_all();
  const std::uint64_t last = state().log.last();
  runner_.command(Signal::kOff, {task("law"), task("filter")}, note());
  runner_.command(Signal::kOn, {task("law")}, note());
  const std::string refusal = "law is in state NOT-CREATED, where on is not legal";
  EXPECT_EQ(answers_.find("1 no: "), 0u) << answers_;
  EXPECT_NE(answers_.find("\n2 no: " + refusal), std::string::npos) << answers_;
  const std::string log = told(last);
  EXPECT_NE(log.find("command: off law, filter: refused: "), std::string::npos) << log;
  EXPECT_NE(log.find("command: on law: refused: " + refusal), std::string::npos) << log;
  const LoggedEvent& event = state().log.at(state().log.last());
  EXPECT_EQ(event.task, task("law")) << "the refused task";
  const std::string both = answers_;
  runner_.step(subsystem::Tick{});
  EXPECT_EQ(answers_, both);
}

TEST_F(StepRunnerTest, ACommandWithNothingToDoIsDone) {
  memory().started = 1;
  runner_.begin();
  end_all();
  const std::uint64_t last = state().log.last();
  runner_.command(Signal::kOff, {}, note());
  EXPECT_EQ(answers_, "1 yes\n");
  EXPECT_EQ(told(last), "command: off: done\n");
}

TEST_F(StepRunnerTest, ACommandThatWaitsIsAnsweredByALaterStep) {
  memory().started = 1;
  runner_.begin();
  runner_.command(Signal::kOn, {task("law")}, note());
  EXPECT_EQ(answers_, "") << "the inventory is not complete";
  end_all();
  EXPECT_EQ(answers_.find("1 no: law is in state"), 0u) << answers_;
}

TEST_F(StepRunnerTest, IsDueWhenTheStepFunctionIs) {
  runner_.begin();
  runner_.step(subsystem::InventoryComplete{});
  const Nanoseconds due = runner_.next_due();
  EXPECT_EQ(due, state().logic.next_due());
  EXPECT_GT(due, now());
  EXPECT_LE(due, now() + seconds(10)) << "rtpus that do not come are given up then";
}

}  // namespace
}  // namespace chimera::manager
