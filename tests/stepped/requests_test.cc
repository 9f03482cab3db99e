// SPDX-License-Identifier: Apache-2.0
// Requests and reactions of tasks: from the component in an rtpu over the manager to the switch and its receipt.
#include <gtest/gtest.h>

#include "tests/stepped/stepped_subsystem.h"

namespace chimera::manager::requests_test {
namespace {

// `asker` requests a configuration by the operator variable `wish`: 1 for `first`, 2 for `second`.
const std::string kTasksAsk = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  asker: {component: t_asker, rtpu: second, rate: 100 Hz, constants: {first: low, second: high}}
  one: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: given, y: level}, constants: {k: 1}}
  two: {component: gain, rtpu: second, rate: 100 Hz, alias: {x: given, y: level}, constants: {k: 1}}
  reader: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: level, y: seen}, constants: {k: 1}}
operator: {wish: 0, given: 5}
configurations:
  low: [steady, asker, one, reader]
  high: {tasks: [steady, asker, two, reader], safe_when: 'seen < 8'}
start: low
)";
const std::string kLow = "steady asker one reader ", kHigh = "steady asker two reader ";

TEST(SteppedRequests, CarryOutRequestsOfATaskAndNameTheTask) {
  for (const std::string& lists : {std::string("{first: low, second: high}"),
                                   std::string("{first: --on one, second: --on two --off one}")}) {
    SteppedSubsystem system(replaced(kTasksAsk, "{first: low, second: high}", lists));
    ASSERT_TRUE(system.until_started());
    system.set("wish", 2);
    ASSERT_TRUE(system.until([&] { return system.on() == kHigh; })) << system.on() << system.events("switch");
    system.set("wish", 1);
    ASSERT_TRUE(system.until([&] { return system.on() == kLow; })) << system.on() << system.events("switch");
    system.run(milliseconds(300));  // thirty cycles that ask for what is in force
    EXPECT_EQ(system.ends(), "high done\nlow done\n");
    for (const Json& receipt : system.receipts()) EXPECT_EQ(receipt["asked_by"], Json({{"task", "asker"}}));
    EXPECT_EQ(system.value("refused"), 0);
  }
}

TEST(SteppedRequests, RefuseTasksThatAreNoLegalSetByName) {
  SteppedSubsystem system(
      replaced(kTasksAsk, "{first: low, second: high}", "{first: --on one, second: --off one two}"));
  ASSERT_TRUE(system.until_started());
  system.set("wish", 2);
  ASSERT_TRUE(system.until([&] { return !system.events("switch").empty(); }));
  const std::string refusal =
      "switch --off one two, asked for by task asker, is refused: level would have no producer\n";
  EXPECT_EQ(system.events("switch"), refusal);
  system.run(milliseconds(250));  // the refused request is made again ten times a second
  EXPECT_EQ(system.events("switch"), refusal + refusal + refusal);
  system.set("wish", 1);  // in force
  system.run(milliseconds(500));
  EXPECT_EQ(system.events("switch"), refusal + refusal + refusal);
  EXPECT_EQ(system.on(), kLow);
  EXPECT_EQ(system.receipts(), Json::array());
}

/// Also if the manager is killed after the answer to the person, and over the death of the rtpu.
TEST(SteppedRequests, LeaveATaskOffThatAPersonTurnedOff) {
  SteppedSubsystem system(kTasksAsk);
  ASSERT_TRUE(system.until_started());
  ASSERT_TRUE(system.call("signal", {{"signal", "off"}, {"tasks", {"two"}}}).is_good());
  system.kill_manager();
  system.start_manager();
  system.die("second");
  ASSERT_TRUE(system.until_on("asker"));
  system.set("wish", 2);
  const std::string refusal =
      "switch to 'high', asked for by task asker, is refused: an operator turned task 'two' OFF\n";
  ASSERT_TRUE(system.until([&] { return system.events("switch") == refusal; })) << system.events("switch");
  EXPECT_EQ(system.on(), kLow);
  EXPECT_EQ(system.result("switch", {{"configuration", "high"}})["end"], "done");
  system.set("wish", 1);
  ASSERT_TRUE(system.until([&] { return system.on() == kLow; })) << system.on();
  system.set("wish", 2);
  EXPECT_TRUE(system.until([&] { return system.on() == kHigh; })) << "a person has turned it ON since";
  ASSERT_TRUE(system.until([&] { return system.receipts().size() == 4; }));
  EXPECT_EQ(system.result("switch", {{"off", {"two"}}, {"on", {"one"}}})["end"], "done");
  const auto refusals = [&] {
    int n = 0;
    for (const Json& one : system.receipts()) n += one["reason"] == "turned-off" ? 1 : 0;
    return n;
  };
  ASSERT_EQ(refusals(), 1);
  EXPECT_TRUE(system.until([&] { return refusals() > 2; })) << "`--off` of a person counts as `off`";
  EXPECT_EQ(system.on(), kLow);
}

TEST(SteppedRequests, WaitForSafeWhenAndNameTheVariableThatDelays) {
  SteppedSubsystem system(kTasksAsk);
  ASSERT_TRUE(system.until_started());
  system.set("given", 9);
  ASSERT_TRUE(system.until([&] { return system.value("seen") == 9; }));
  const Json receipt = system.result("switch", {{"configuration", "high"}, {"wait_ms", 300}});
  EXPECT_EQ(receipt["end"], "aborted");
  EXPECT_EQ(receipt["reason"], "not-safe");
  EXPECT_EQ(receipt["why"], "'seen' is 9, and safe_when of 'high' asks for seen < 8");
  EXPECT_EQ(system.on(), kLow);
  const PendingAnswer waits = system.ask("switch", {{"configuration", "high"}});
  system.run(milliseconds(300));
  EXPECT_EQ(system.on(), kLow);
  EXPECT_FALSE(waits->has_value());
  system.set("given", 5);
  ASSERT_TRUE(system.until([&] { return waits->has_value(); }));
  EXPECT_EQ(system.on(), kHigh);
}

/// The manager is killed at each step of 100 us after the task began to ask; its successor takes the request up.
TEST(SteppedRequests, OutliveTheManagerAtEveryStep) {
  for (int steps = 0; steps < 60; ++steps) {
    SteppedSubsystem system(kTasksAsk);
    ASSERT_TRUE(system.until_started());
    (void)system.ask("set", {{"values", {{"wish", 2}}}});
    system.run(microseconds(100) * steps);
    system.kill_manager();
    system.run(milliseconds(20));
    system.start_manager();
    if (system.value("wish") != 2) system.set("wish", 2);  // the manager died before it took the value
    ASSERT_TRUE(system.until([&] { return system.on() == kHigh; })) << steps << ": " << system.on();
    ASSERT_TRUE(system.until([&] { return !system.receipts().empty(); })) << steps;
    EXPECT_EQ(system.ends(), "high done\n") << steps;
  }
}

// The task that fails is left behind, in the other rtpu than `steady`.
const std::string kFails = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz, alias: {count: counted}}
  thrower:
    component: t_thrower
    rtpu: second
    rate: 100 Hz
    constants: {where: cycle, how: 3, at: 100, recovers: false}
    on_fault: REACTION
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
configurations: {all: [steady, thrower, beside], less: [steady]}
start: all
)";
// The task of the second rtpu uses up to 9 ms of each 10.
const std::string kLate = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 100 Hz}
  bad: {component: t_overrun, rtpu: second, rate: 100 Hz, constants: {allowed: 3000000 ns}, REACTION}
configurations: {all: [steady, bad], less: [steady]}
start: all
)";

TEST(SteppedReactions, LeadToAnotherConfigurationAfterAFault) {
  SteppedSubsystem system(replaced(kFails, "REACTION", "{switch: less}"));
  ASSERT_TRUE(system.until_started());
  ASSERT_TRUE(system.until([&] { return system.on() == "steady "; })) << system.on();
  EXPECT_EQ(system.state("thrower"), State::kError);
  ASSERT_TRUE(system.until([&] { return !system.receipts().empty(); }));
  EXPECT_EQ(system.receipts()[0]["asked_by"], Json({{"reaction", "on_fault"}, {"task", "thrower"}}));
  EXPECT_EQ(system.ends(), "less done\n");
}

TEST(SteppedReactions, LeadToAnotherConfigurationAfterAMissAndAfterAnOverrun) {
  for (const auto& [reaction, words] : {std::pair("on_miss", "deadline: 1 ms, on_miss: {switch: less}"),
                                        std::pair("on_overrun", "budget: 500 us, on_overrun: {switch: less}")}) {
    SteppedSubsystem system(replaced(kLate, "REACTION", words));
    ASSERT_TRUE(system.until([&] { return system.on() == "steady "; })) << reaction << system.on();
    ASSERT_TRUE(system.until([&] { return !system.receipts().empty(); })) << reaction;
    EXPECT_EQ(system.receipts()[0]["asked_by"], Json({{"reaction", reaction}, {"task", "bad"}}));
    EXPECT_EQ(system.ends(), "less done\n") << reaction;
    EXPECT_EQ(system.state("bad"), State::kOff) << reaction;
  }
}

/// The manager that dies has handled the first fault; the second fault comes before its successor.
TEST(SteppedReactions, RepeatTheirRequestWhileTheManagerIsDead) {
  SteppedSubsystem system(replaced(kFails, "REACTION", "{switch: less}"));
  ASSERT_TRUE(system.until([&] { return system.manager().is_ready() && system.ends() == "less done\n"; }));
  EXPECT_EQ(system.signal("kill", "thrower"), "");
  EXPECT_EQ(system.signal("spawn", "thrower"), "");
  EXPECT_EQ(system.switch_to("all")["end"], "done");
  system.kill_manager();
  system.run(seconds(2));
  system.start_manager();
  EXPECT_TRUE(system.until([&] { return system.ends() == "less done\nall done\nless done\n"; })) << system.ends();
  EXPECT_EQ(system.on(), "steady ");
}

TEST(SteppedReactions, RaiseTheFlagInEveryRtpuUntilTheTaskIsCleared) {
  SteppedSubsystem system(replaced(kFails, "REACTION", "flag"));
  ASSERT_TRUE(system.until_started());
  ASSERT_TRUE(system.until([&] { return system.flag(); }));
  EXPECT_EQ(system.state("thrower"), State::kError);
  EXPECT_EQ(system.on(), "steady beside ");
  const control::RpcResponse refused = system.call("switch", {{"configuration", "all"}});
  EXPECT_EQ(refused.detail("kind"), "in-error");
  EXPECT_EQ(refused.detail("where"), "thrower");
  EXPECT_EQ(refused.detail("remedy"), "`chimera clear thrower`");
  EXPECT_EQ(system.signal("clear", "thrower"), "");
  EXPECT_TRUE(system.until([&] { return !system.flag(); }));
}

TEST(SteppedReactions, StopTurnsTheTasksOfTheRtpuOff) {
  SteppedSubsystem system(replaced(kFails, "REACTION", "stop"));
  ASSERT_TRUE(system.until_started());
  ASSERT_TRUE(system.until([&] { return system.on() == "steady "; })) << system.on();
  EXPECT_EQ(system.state("thrower"), State::kError);
  EXPECT_EQ(system.state("beside"), State::kOff);
}

}  // namespace
}  // namespace chimera::manager::requests_test
