// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/answer/why.h"

#include <gtest/gtest.h>

#include <map>

namespace chimera::manager {
namespace {

/// x of sensor -> q of filter -> tau of pid, kp of the operator -> tau; arm closes the loop: tau -> x.
class WhyTest : public ::testing::Test {
 protected:
  WhyTest() {
    add("tau", "pid", {"q", "kp"});
    add("q", "filter", {"x"});
    add("x", "arm", {"tau"});
    add("kp", "operator", {});
    facts_["kp"].period = {};
    facts_["kp"].age = seconds(100);
  }
  void add(const std::string& name, const std::string& producer, std::vector<std::string> inputs) {
    VariableFacts& f = facts_[name];
    f.variable = name;
    f.producer = f.component = producer;
    f.rtpu = "servo";
    f.state = State::kOn;
    f.period = milliseconds(1);
    f.age = microseconds(400);
    f.is_written = true;
    f.value = "[nan 1] rad";
    f.inputs = std::move(inputs);
  }
  Why ask(const std::string& name) {
    return why(name, [this](std::string_view v) { return facts_.at(std::string(v)); });
  }
  std::string verdict(const std::string& name) { return ask(name).verdict; }

  std::map<std::string, VariableFacts> facts_;
};

TEST_F(WhyTest, NamesEveryAncestorOnceNearestFirst) {
  const Why answer = ask("tau");
  std::string chain;
  for (const WhyLink& link : answer.chain) chain += link.facts.variable + std::to_string(link.depth) + " ";
  EXPECT_EQ(chain, "tau0 q1 kp1 x2 ");
  EXPECT_EQ(answer.verdict, "tau is good: pid wrote it 400 us ago, and all 3 variables it depends on are good too");
}

TEST_F(WhyTest, AnOperatorsVariableIsNeverStaleAndStandsAlone) {
  EXPECT_EQ(verdict("kp"), "kp is good: set by the operator");
}

TEST_F(WhyTest, FindsTheStaleAncestor) {
  facts_["x"].age = milliseconds(12);
  EXPECT_EQ(verdict("tau"), "tau depends on x: stale: arm wrote it 12 ms ago, its period is 1 ms");
  EXPECT_EQ(verdict("x"), "x: stale: arm wrote it 12 ms ago, its period is 1 ms");
}

TEST_F(WhyTest, ThreePeriodsAreNotYetStaleAndADeclaredLimitCounts) {
  facts_["x"].age = milliseconds(3);
  EXPECT_EQ(ask("x").chain[0].trouble, VariableTrouble::kNone);
  facts_["x"].stale_after = milliseconds(2);
  EXPECT_EQ(ask("x").chain[0].trouble, VariableTrouble::kStale);
}

TEST_F(WhyTest, FollowsWrongNumbersToTheirSourceAndLeavesALoopWhereItEnteredIt) {
  facts_["tau"].is_finite = facts_["q"].is_finite = false;
  EXPECT_EQ(verdict("tau"), "tau depends on q: filter published [nan 1] rad");
  facts_["x"].is_finite = false;
  EXPECT_EQ(verdict("tau"), "tau depends on x: arm published [nan 1] rad");
}

TEST_F(WhyTest, EveryTroubleHasItsSentence) {
  VariableFacts& x = facts_["x"];
  x.is_written = false;
  EXPECT_EQ(verdict("x"), "x: never written, though its producer arm is ON");
  x.component = "puma";
  x.state = State::kOff;
  EXPECT_EQ(verdict("x"), "x: its producer arm (puma) is OFF");
  x.state = State::kError;
  x.last_words = "cycle: joint 3 at its limit";
  EXPECT_EQ(verdict("x"), "x: its producer arm (puma) is in ERROR: cycle: joint 3 at its limit");
  x.state = State::kNotCreated;
  EXPECT_EQ(verdict("x"), "x: its producer arm (puma) was not created");
  x.is_rtpu_dead = true;
  x.last_words = "servo ended by signal 9 (SIGKILL)";
  EXPECT_EQ(verdict("x"),
            "x: the rtpu servo of its producer arm (puma) is dead: servo ended by signal 9 (SIGKILL)");
  x.is_rtpu_dead = false;
  x.producer.clear();
  EXPECT_EQ(verdict("x"), "x: no task that produces it was created");
}

TEST_F(WhyTest, PrintsFailuresOfTimeWithALateVariable) {
  VariableFacts& x = facts_["x"];
  x.timing = "3 missed, 1 demoted";
  EXPECT_EQ(ask("x").chain[0].trouble, VariableTrouble::kNone);
  x.age = milliseconds(12);
  EXPECT_EQ(verdict("x"), "x: stale: arm wrote it 12 ms ago, its period is 1 ms (3 missed, 1 demoted)");
  x.is_written = false;
  EXPECT_EQ(verdict("x"), "x: never written, though its producer arm is ON (3 missed, 1 demoted)");
  x.waits_for_events = true;
  EXPECT_EQ(verdict("x"), "x: never written, though its producer arm is ON: it waits for an event");
}

TEST_F(WhyTest, TroublesHaveTheirWords) {
  EXPECT_STREQ(trouble_name(VariableTrouble::kRtpuDead), "rtpu-dead");
  EXPECT_STREQ(trouble_name(VariableTrouble::kStale), "stale");
  EXPECT_STREQ(trouble_name(VariableTrouble::kNone), "ok");
}

}  // namespace
}  // namespace chimera::manager
