// SPDX-License-Identifier: Apache-2.0
// A slow switch over two rtpus: two tasks make the same constants, a third task uses them and stays.
#include <gtest/gtest.h>

#include "tests/stepped/stepped_kills.h"

namespace chimera::manager::slow_switch_test {
namespace {

const std::string kSlow = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  light: {component: t_constants, rtpu: first, rate: 1 kHz, constants: {joints: 2, scale: 0.5 m}}
  heavy: {component: t_constants, rtpu: second, rate: 1 kHz, constants: {joints: 3, scale: 2 m}}
  user: {component: t_extent, rtpu: second, rate: 1 kHz}
  beside: {component: t_counter, rtpu: first, rate: 1 kHz}
operator: {q: 1 rad}
configurations:
  with_light: [light, user, beside]
  with_heavy: [heavy, user, beside]
start: with_light
)";
const std::string kLight = "light user beside ", kHeavy = "heavy user beside ";

bool sees(SteppedSubsystem& system, const Json& arc) {
  return system.result("get", {{"variables", Json::array({"arc"})}})["values"]["arc"]["value"] == arc;
}
bool sees_light(SteppedSubsystem& system) { return sees(system, Json::array({0.5, 1})); }
bool sees_heavy(SteppedSubsystem& system) { return sees(system, Json::array({2, 4, 6})); }

TEST(SteppedSlowSwitch, ChangesConstantsUnderATaskThatStays) {
  SteppedSubsystem system(kSlow);
  ASSERT_TRUE(system.until_started());
  ASSERT_TRUE(system.until([&] { return sees_light(system); }));
  const Json plan = system.result("plan", {{"configuration", "with_heavy"}});
  EXPECT_EQ(plan["end"], "possible");
  EXPECT_EQ(plan["way"], "slow");
  EXPECT_EQ(plan["slow_because"], Json::array({"constants"}));
  EXPECT_NE(text_at(plan, "slow_why").find("of task 'user', which stays, changes"), std::string::npos) << plan;
  for (const char* target : {"with_heavy", "with_light"}) {
    const Json receipt = system.result("switch", {{"configuration", target}});
    EXPECT_EQ(receipt["end"], "done") << receipt;
    EXPECT_EQ(receipt["way"], "slow");
    EXPECT_EQ(receipt["reinitialised"], Json::array({"user"}));
    EXPECT_TRUE(receipt["not_back"].is_null());
    EXPECT_GT(whole_at(receipt, "flag_ns"), 0);
    EXPECT_FALSE(truth_at(system.result("status")["flag"], "up"));
    const bool is_heavy = receipt["to"] == "with_heavy";
    EXPECT_EQ(system.on(), is_heavy ? kHeavy : kLight);
    EXPECT_TRUE(system.until([&] { return is_heavy ? sees_heavy(system) : sees_light(system); }));
  }
}

class SteppedSlowSwitchKills : public ::testing::TestWithParam<std::vector<std::string>> {};

TEST_P(SteppedSlowSwitchKills, AtEveryStepLeaveOneSideInForceAndOneReceipt) {
  KillsInASwitch{kSlow, {"with_light", kLight, sees_light}, {"with_heavy", kHeavy, sees_heavy}}.at_every_step(
      GetParam());
}

INSTANTIATE_TEST_SUITE_P(Of, SteppedSlowSwitchKills, ::testing::ValuesIn(kMishaps));

}  // namespace
}  // namespace chimera::manager::slow_switch_test
