// SPDX-License-Identifier: Apache-2.0
// A switch of configurations over two rtpus: all or nothing, one receipt, whichever process dies at whichever step.
#include <gtest/gtest.h>

#include "tests/stepped/stepped_kills.h"

namespace chimera::manager::switch_test {
namespace {

// One variable, `wanted`, by a task of the first rtpu or by one of the second; both rtpus read it.
const std::string kSwitch = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  reference:
    {component: signal_generator, rtpu: first, rate: 1 kHz, alias: {y: vref},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  slow: {component: gain, rtpu: first, rate: 1 kHz, alias: {x: vref, y: wanted}, constants: {k: 2}}
  fast:
    {component: gain, rtpu: second, rate: 1 kHz, alias: {x: vref, y: wanted}, constants: {k: 4}, max_step: {y: 3 m/s}}
  steep:
    {component: gain, rtpu: second, rate: 1 kHz, alias: {x: vref, y: wanted}, constants: {k: 40}, max_step: {y: 3 m/s}}
  here: {component: gain, rtpu: first, rate: 500 Hz, alias: {x: wanted, y: seen_here}, constants: {k: 1}}
  there: {component: gain, rtpu: second, rate: 500 Hz, alias: {x: wanted, y: seen_there}, constants: {k: 1}}
configurations:
  gentle: [reference, slow, here, there]
  quick: [reference, fast, here, there]
  wild: [reference, steep, here, there]
start: gentle
)";
const std::string kGentle = "reference slow here there ", kQuick = "reference fast here there ";

bool both_see(SteppedSubsystem& system, double value) {
  return system.value("seen_here") == value && system.value("seen_there") == value;
}
Json switched(SteppedSubsystem& system, const std::string& configuration) {
  return system.result("switch", {{"configuration", configuration}});
}
/// The moves of the tasks of a receipt, in the order of the description.
std::string moves(const Json& receipt) {
  std::string text;
  for (const char* name : {"reference", "slow", "fast", "steep", "here", "there"})
    for (const Json& task : receipt["tasks"])
      if (text_at(task, "task") == name) text += text_at(task, "move") + " ";
  return text;
}

TEST(SteppedSwitch, GoesThereAndBackWithoutFlagAndWithoutALostCycle) {
  SteppedSubsystem system(kSwitch);
  ASSERT_TRUE(system.until_started());
  for (int number = 1; number <= 4; ++number) {
    const bool is_there = number % 2 == 1;
    const Json receipt = switched(system, is_there ? "quick" : "gentle");
    EXPECT_EQ(receipt["number"], number);
    EXPECT_EQ(receipt["end"], "done") << receipt;
    EXPECT_EQ(receipt["way"], "fast") << receipt;
    EXPECT_EQ(receipt["flag_ns"], 0);
    EXPECT_EQ(receipt["asked_by"]["role"], "configure");
    EXPECT_EQ(moves(receipt), is_there ? "stays leaves arrives stays stays " : "stays arrives leaves stays stays ");
    for (const Json& task : receipt["tasks"]) EXPECT_EQ(task["lost"], 0) << task;
    EXPECT_EQ(receipt["variables"].size(), 1u);
    EXPECT_EQ(receipt["variables"][std::size_t{0}]["step_of_on"], 2);
    EXPECT_EQ(system.on(), is_there ? kQuick : kGentle);
    EXPECT_TRUE(system.until([&] { return both_see(system, is_there ? 4 : 2); }));
  }
  EXPECT_EQ(switched(system, "gentle"), Json({{"to", "gentle"}, {"end", "nothing-to-do"}}));
  EXPECT_EQ(system.events("flag"), "");
}

TEST(SteppedSwitch, TurnsTasksOnAndOffByNameAndNamesTheConfigurationThatTheyMake) {
  SteppedSubsystem system(kSwitch);
  ASSERT_TRUE(system.until_started());
  const auto asked = [&](const Json& lists) { return system.result("switch", lists); };
  const auto refusal = [&](const Json& lists) {
    const control::RpcResponse answer = system.call("switch", lists);
    EXPECT_EQ(answer.detail("kind"), "set");
    return answer.message;
  };
  EXPECT_EQ(asked({{"on", Json::array({"fast"})}})["to"], "quick");
  EXPECT_EQ(system.on(), kQuick);
  const Json less = asked({{"off", Json::array({"there"})}});
  EXPECT_EQ(less["end"], "done");
  EXPECT_TRUE(less["to"].is_null());
  EXPECT_EQ(system.on(), "reference fast here ");
  EXPECT_EQ(asked({{"off", Json::array({"there"})}})["end"], "nothing-to-do");
  EXPECT_EQ(refusal({{"off", Json::array({"fast"})}}),
            "wanted would have no producer, and there is a choice: 'slow' or 'steep'");
  EXPECT_EQ(refusal({{"off", Json::array({"reference"})}}), "vref would have no producer");
  EXPECT_EQ(refusal({{"on", Json::array({"slow", "steep"})}}), "wanted would have two producers: slow and steep");
  const Json back = asked({{"on", Json::array({"slow", "there"})}});
  EXPECT_EQ(back["to"], "gentle");
  EXPECT_TRUE(back["from"].is_null());
  EXPECT_EQ(system.on(), kGentle);
}

TEST(SteppedSwitch, ASwitchWithTooLargeAStepChangesNothing) {
  SteppedSubsystem system(kSwitch);
  ASSERT_TRUE(system.until_started());
  EXPECT_EQ(switched(system, "quick")["end"], "done");
  const Json receipt = switched(system, "wild");
  EXPECT_EQ(receipt["end"], "aborted");
  EXPECT_EQ(receipt["reason"], "step-too-large");
  EXPECT_NE(text_at(receipt, "why").find("'wanted' too far: by 36 m/s, limit 3 m/s"), std::string::npos) << receipt;
  EXPECT_EQ(system.on(), kQuick);
  EXPECT_TRUE(system.until([&] { return both_see(system, 4); }));
}

TEST(SteppedSwitch, IsRefusedWithTheNearestNameAndWithTheCommandThatHelps) {
  SteppedSubsystem system(kSwitch);
  ASSERT_TRUE(system.until_started());
  EXPECT_EQ(system.call("switch", {{"configuration", "quic"}}).detail("nearest"), "quick");
  const Json kill = {{"signal", "kill"}, {"tasks", Json::array({"fast"})}};
  const Json spawn = {{"signal", "spawn"}, {"tasks", Json::array({"fast"})}};
  (void)system.result("signal", kill);
  const control::RpcResponse refused = system.call("switch", {{"configuration", "quick"}});
  EXPECT_EQ(refused.detail("kind"), "not-created");
  EXPECT_EQ(refused.detail("where"), "fast");
  EXPECT_EQ(refused.detail("remedy"), "`chimera spawn fast`");
  (void)system.result("signal", spawn);
  EXPECT_EQ(switched(system, "quick")["end"], "done");
}

TEST(SteppedSwitch, ASwitchThatRisksADeadlineIsSlowUnderTheFlag) {
  std::string text = kSwitch;
  const auto replace = [&](const std::string& what, const std::string& with) {
    for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
      text.replace(at, what.size(), with);
  };
  replace("rate: 1 kHz", "rate: 100 Hz");
  replace("rate: 500 Hz", "rate: 50 Hz");
  replace("constants: {k: 2}}", "constants: {k: 2}, budget: 8 ms}");
  replace("configurations:", R"(  late:
    {component: gain, rtpu: first, rate: 100 Hz, offset: 9 ms, budget: 8 ms, alias: {x: vref, y: wanted},
     constants: {k: 2}}
configurations:
  after: [reference, late, here, there])");
  SteppedSubsystem system(text);
  ASSERT_TRUE(system.until_started());
  const Json plan = system.result("plan", {{"configuration", "after"}});
  EXPECT_EQ(plan["way"], "slow");
  EXPECT_EQ(plan["slow_because"], Json::array({"not-schedulable"}));
  EXPECT_GT(whole_at(plan, "expected_ns"), 0);
  const Json slow = switched(system, "after");
  EXPECT_EQ(slow["end"], "done") << slow;
  EXPECT_EQ(slow["way"], "slow");
  EXPECT_NE(text_at(slow, "slow_why").find("the transition from 'gentle' to 'after' is not schedulable on CPU"),
            std::string::npos);
  EXPECT_GT(whole_at(slow, "flag_ns"), 0);
  EXPECT_EQ(system.on(), "reference here there late ");
  EXPECT_FALSE(truth_at(system.result("status")["flag"], "up"));
  const Json fast = switched(system, "quick");  // there is room for both
  EXPECT_EQ(fast["way"], "fast") << fast;
  EXPECT_EQ(fast["flag_ns"], 0);
}

class SteppedSwitchKills : public ::testing::TestWithParam<std::vector<std::string>> {};

TEST_P(SteppedSwitchKills, AtEveryStepLeaveOneConfigurationInForceAndOneReceipt) {
  KillsInASwitch{kSwitch,
                 {"gentle", kGentle, [](SteppedSubsystem& system) { return both_see(system, 2); }},
                 {"quick", kQuick, [](SteppedSubsystem& system) { return both_see(system, 4); }}}
      .at_every_step(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Of, SteppedSwitchKills, ::testing::ValuesIn(kMishaps));

}  // namespace
}  // namespace chimera::manager::switch_test
