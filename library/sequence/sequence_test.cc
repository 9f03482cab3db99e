// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/task/rig.h"
#include "library/sequence/step.h"
#include "library/sequence/testing/sequence_model.h"

namespace chimera {
namespace {

using library::SequenceInput;
using library::SequenceState;
using library::SequenceStep;
using library::SequenceSteps;
using State = SequenceState;

/// A machine with steps and a clock of 100 ms.
struct Steps {
  std::vector<SequenceStep> steps;
  SequenceSteps machine;
  SequenceInput in;
  std::string note;

  explicit Steps(std::vector<SequenceStep> made, bool repeats = false) : steps(std::move(made)) {
    machine.prepare(steps, repeats);
    machine.on({}, false);
  }
  State cycle(std::string_view in_force, std::int32_t go = -1, bool holds = false, bool illegal = false) {
    in.now += milliseconds(100);
    in.in_force = in_force;
    in.go = go;
    in.holds = holds;
    in.illegal = illegal;
    machine.cycle(in);
    if (machine.note()[0] != '\0') note = machine.note();
    return machine.state();
  }
  /// The last state of `n` equal cycles.
  State cycles(int n, std::string_view in_force) {
    for (int i = 1; i < n; ++i) cycle(in_force);
    return cycle(in_force);
  }
};

SequenceStep until(std::string_view name, std::int32_t otherwise = -1, bool reentry = false) {
  return {name, name, seconds(2), {}, true, otherwise, false, reentry};
}
SequenceStep wait_for(std::string_view name, Nanoseconds wait) {
  return {name, name, seconds(2), wait, false, -1, false, false};
}

TEST(SequenceSteps, GoesFromStepToStep) {
  Steps s({until("near"), wait_for("grip", milliseconds(300)),
           {"home", "home", seconds(2), {}, false, -1, false, false}});
  EXPECT_EQ(s.cycle("", 1), State::kBegins) << "the start configuration is not complete";
  EXPECT_EQ(s.cycle("near"), State::kRuns) << "it is in force already";
  EXPECT_EQ(s.cycle("near"), State::kRuns);
  EXPECT_EQ(s.cycle("near", -1, true), State::kSwitches);
  EXPECT_EQ(s.machine.request(), 1) << "in the same cycle";
  EXPECT_EQ(s.machine.step(), 2);
  EXPECT_EQ(s.cycle("near"), State::kSwitches);
  EXPECT_EQ(s.machine.request(), -1);
  EXPECT_EQ(s.cycles(2, "grip"), State::kRuns);
  EXPECT_EQ(s.machine.waited(s.in.now), milliseconds(100));
  EXPECT_EQ(s.cycles(2, "grip"), State::kSwitches);
  EXPECT_EQ(s.cycle("home"), State::kDone);
  EXPECT_EQ(s.machine.step(), 3);
}

TEST(SequenceSteps, RequestsEachSecondUntilTheTimeIsOver) {
  Steps s({until("near"), until("grip", 0)});
  s.cycle("near", 1);
  s.cycle("near", -1, true);
  int requests = 1;
  for (int i = 0; i < 19; ++i) {
    EXPECT_EQ(s.cycle("near"), State::kSwitches) << i;
    requests += s.machine.request() == 1 ? 1 : 0;
  }
  EXPECT_EQ(requests, 2);
  EXPECT_EQ(s.cycle("near"), State::kSwitches);
  EXPECT_EQ(s.machine.step(), 1);
  EXPECT_EQ(s.machine.request(), -1) << "its else is in force already";
  EXPECT_EQ(s.cycle("near"), State::kRuns);
  EXPECT_EQ(s.note, "step 2 'grip' failed: its configuration does not come into force; goes to step 1 'near'");
}

TEST(SequenceSteps, StopsIfAConditionDoesNotHoldInTime) {
  Steps s({until("near")});
  s.cycle("near", 1);
  EXPECT_EQ(s.cycles(19, "near"), State::kRuns);
  EXPECT_EQ(s.cycle("near"), State::kFailed);
  EXPECT_EQ(s.note, "step 1 'near' failed: its condition does not hold; stopped");
  EXPECT_EQ(s.cycle("near", 1), State::kRuns) << "Go begins it anew";
}

TEST(SequenceSteps, PausesForAPersonWhoSwitchesOtherwise) {
  Steps s({until("near"), until("grip", -1, true)});
  s.cycle("near", 1);
  EXPECT_EQ(s.cycle("park"), State::kPaused);
  EXPECT_EQ(s.note, "switched otherwise in 'park': paused; may go on with step 2");
  EXPECT_EQ(s.cycles(20, "grip"), State::kPaused);
  EXPECT_EQ(s.cycle("grip", 2), State::kRuns);
}

TEST(SequenceSteps, PausesForAPersonWhoSwitchesSlowlyToAStepWithReentry) {
  Steps s({until("near"), until("grip", -1, true)});
  s.cycle("near", 1);
  EXPECT_EQ(s.cycle("near", -1, false, true), State::kInterrupted) << "a slow switch raises the flag";
  EXPECT_EQ(s.cycle("grip"), State::kPaused);
}

TEST(SequenceSteps, GoesOnAfterAnErrorOnlyWhereReentryIsAllowed) {
  Steps s({until("near"), until("grip", -1, true)});
  s.cycle("near", 1);
  EXPECT_EQ(s.cycle(""), State::kInterrupted);
  EXPECT_EQ(s.cycle("near"), State::kPaused);
  EXPECT_EQ(s.note, "interrupted in 'near': paused; may go on with step 2");
  s.cycle("near", 1);
  s.cycle("");
  EXPECT_EQ(s.cycle("grip"), State::kRuns) << "a reaction switched there";
  EXPECT_EQ(s.machine.step(), 2);
}

TEST(SequenceSteps, GoesOnAfterAnEmergencyStopOnlyWhereReentryIsAllowed) {
  for (const bool reentry : {false, true}) {
    Steps s({until("near", -1, reentry)});
    s.cycle("near", 1);
    EXPECT_EQ(s.cycle("near", -1, true, true), State::kInterrupted) << "the condition does not count under the flag";
    EXPECT_EQ(s.cycles(1, "near"), reentry ? State::kRuns : State::kPaused);
  }
}

TEST(SequenceSteps, DoesNotSwitchAfterAnEmergencyStopDuringARequest) {
  Steps s({until("near"), until("grip")});
  s.cycle("near", 1);
  s.cycle("near", -1, true);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(s.cycle("near", -1, false, true), State::kSwitches);
  EXPECT_EQ(s.machine.request(), -1) << "no request under the flag";
  EXPECT_EQ(s.cycle("near"), State::kPaused);
}

TEST(SequenceSteps, FollowsItsOwnSlowSwitch) {
  Steps s({until("near"), until("grip")});
  s.cycle("near", 1);
  s.cycle("near", -1, true);
  for (int i = 0; i < 30; ++i) EXPECT_EQ(s.cycle("near", -1, false, true), State::kSwitches);
  EXPECT_EQ(s.cycle("grip"), State::kRuns);
}

TEST(SequenceSteps, APersonBeginsAStepUnderTheFlag) {
  Steps s({until("near"), until("grip")});
  s.cycle("near", 1);
  s.cycle("");
  EXPECT_EQ(s.cycle("", 2, false, true), State::kSwitches);
  EXPECT_EQ(s.machine.request(), 1);
  EXPECT_EQ(s.cycle("grip"), State::kRuns);
}

TEST(SequenceSteps, WaitsForGo) {
  Steps s({until("near"), {"home", "home", seconds(2), {}, false, -1, true, false}});
  s.cycle("near", 1);
  EXPECT_EQ(s.cycle("near", -1, true), State::kWaitsForGo);
  EXPECT_EQ(s.note, "step 2 'home' waits for Go");
  EXPECT_EQ(s.cycles(99, "near"), State::kWaitsForGo);
  EXPECT_EQ(s.cycle("near", 2), State::kSwitches);
  EXPECT_EQ(s.cycle("home"), State::kDone);
}

TEST(SequenceSteps, BeginsAnewAfterAPause) {
  Steps s({wait_for("near", seconds(1))});
  s.cycle("near", 1);
  s.cycles(8, "near");
  EXPECT_EQ(s.cycle("near", 0), State::kPaused);
  EXPECT_EQ(s.cycles(20, "near"), State::kPaused);
  s.cycle("near", 1);
  EXPECT_EQ(s.cycles(9, "near"), State::kRuns);
  EXPECT_EQ(s.cycle("near"), State::kDone);
  EXPECT_EQ(s.cycle("near", 9), State::kDone);
  EXPECT_EQ(s.note, "there is no step 9: the last one is 1");
}

TEST(SequenceSteps, GoesOnAfterADeathOnlyWhereReentryIsAllowed) {
  Steps s({until("near", -1, true), until("grip")});
  s.machine.on({}, true);
  EXPECT_EQ(s.cycle(""), State::kInterrupted);
  EXPECT_EQ(s.cycle("near"), State::kRuns);
  Steps other({until("near", -1, true), until("grip")});
  other.machine.on({}, true);
  EXPECT_EQ(other.cycle("grip"), State::kPaused);
}

TEST(SequenceSteps, DoAsTheModelIn1000RandomSequences) {
  for (unsigned seed = 1; seed <= 1000; ++seed) ASSERT_EQ(library::compare_with_model(seed), "") << "seed " << seed;
}


/// The component with two steps: `near` until value[0] <= 5, then `rest` for 100 ms.
struct SequenceTest : ::testing::Test {
  Rig rig{"sequence"};

  void SetUp() override {
    for (const char* port : {"value", "level"}) rig.instances(port, 1);
    rig.instances("configuration", 2);
    rig.extent("n", 1);
    rig.extent("steps", 2);
    rig.set("configuration", Text<72>("near"), 0, 0);
    rig.set("configuration", Text<72>("rest"), 0, 1);
    rig.set("level", 5.0);
    rig.set("step", library::Step{"near", 2, 0, 0, 0, 1, -1, false, true}, 0);
    rig.set("step", library::Step{"rest", 2, 0.1, -1, 0, 0, -1, false, false}, 1);
    rig.set("repeat", false);
    rig.set("value", 4.0);
    rig.configuration("near");
  }
  void start(std::int32_t go = 1) {
    ASSERT_TRUE(rig.init());
    rig.set("sequence_go", go);
    ASSERT_TRUE(rig.on());
  }
  State cycle() {
    EXPECT_TRUE(rig.cycle(milliseconds(10)));
    return static_cast<State>(rig.get<std::int32_t>("sequence_state"));
  }
};

TEST_F(SequenceTest, CountsOnlyValuesPublishedSinceTheStepBegan) {
  start();
  EXPECT_EQ(cycle(), State::kRuns);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(cycle(), State::kRuns) << "4 was published before";
  EXPECT_EQ(rig.get<double>("sequence_waited"), 0.1);
  rig.set("value", 6.0);
  EXPECT_EQ(cycle(), State::kRuns);
  rig.set("value", 5.0);
  EXPECT_EQ(cycle(), State::kSwitches);
  EXPECT_EQ(rig.signals(), std::vector<std::string>{"request rest"});
  EXPECT_EQ(rig.get<std::int32_t>("sequence_step"), 2);
  rig.configuration("rest");
  for (int i = 0; i < 10; ++i) EXPECT_EQ(cycle(), State::kRuns);
  EXPECT_EQ(cycle(), State::kDone);
  EXPECT_FALSE(rig.get<bool>("sequence_failed"));
}

TEST_F(SequenceTest, ANumberThatIsNoneHoldsNothing) {
  start();
  cycle();
  rig.set("value", std::nan(""));
  for (int i = 0; i < 199; ++i) EXPECT_EQ(cycle(), State::kRuns);
  EXPECT_EQ(cycle(), State::kFailed);
  EXPECT_TRUE(rig.get<bool>("sequence_failed"));
}

TEST_F(SequenceTest, GoCountsAgainIfTheValueIsTheSame) {
  start(0);
  EXPECT_EQ(cycle(), State::kPaused);
  rig.set("sequence_go", 1);
  EXPECT_EQ(cycle(), State::kRuns);
  for (int i = 0; i < 250; ++i) cycle();
  EXPECT_EQ(cycle(), State::kFailed);
  rig.set("sequence_go", 1);
  EXPECT_EQ(cycle(), State::kRuns);
}

TEST_F(SequenceTest, GoesOnAfterOffAndOnWithANewWait) {
  start();
  for (int i = 0; i < 150; ++i) cycle();
  ASSERT_TRUE(rig.off());
  ASSERT_TRUE(rig.on());
  for (int i = 0; i < 199; ++i) EXPECT_EQ(cycle(), State::kRuns) << i;
  EXPECT_EQ(cycle(), State::kFailed);
}

TEST_F(SequenceTest, GoesOnWithTheStepThatAllowsReentryAfterADeathOfItsProcess) {
  rig.incarnation(2);
  start();
  EXPECT_EQ(cycle(), State::kRuns);
  EXPECT_EQ(rig.notes(), std::vector<std::string>{"goes on with step 1 'near'"});
  ASSERT_TRUE(rig.init());
  rig.configuration("rest");
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(cycle(), State::kPaused) << "'rest' does not allow reentry";
}

TEST_F(SequenceTest, RefusesAStepThatNamesWhatIsNotThere) {
  const library::Step good{"near", 2, 0, 0, 0, 1, -1, false, true};
  const auto refusal = [&](auto change) {
    library::Step step = good;
    change(step);
    rig.set("step", step, 0);
    return rig.init().text;
  };
  EXPECT_EQ(refusal([](auto& step) { step.input = 1; }), "a step has no input of that number");
  EXPECT_EQ(refusal([](auto& step) { step.element = 1; }),
            "a condition names an element that its variable does not have");
  EXPECT_EQ(refusal([](auto& step) { step.relation = 6; }), "a condition has no such comparison");
  EXPECT_EQ(refusal([](auto& step) { step.otherwise = 2; }), "`otherwise` names no step");
  EXPECT_EQ(refusal([](auto& step) { step.within = 0; }), "a step needs `within` above 0, and `wait` of 0 or more");
  rig.instances("configuration", 1);
  EXPECT_EQ(refusal([](auto&) {}), "`step` and `configuration` differ in length");
}

}  // namespace
}  // namespace chimera
