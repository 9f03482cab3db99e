// SPDX-License-Identifier: Apache-2.0
// A standby takes over, whichever process dies and at every step, with and without a manager.
#include <gtest/gtest.h>

#include "chimera/manager/testing/stepped_subsystem.h"

namespace chimera::manager::standby_stepped_test {

// `wanted` comes from a task of the first rtpu or from its standby in the second one; `user` reads it in the second.
const std::string kStandby = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  reference:
    {component: signal_generator, rtpu: second, rate: 100 Hz, alias: {y: vref},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  main: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 2}}
  spare: {component: gain, rtpu: second, rate: 50 Hz, alias: {x: vref, y: wanted}, constants: {k: 3}, standby_for: main}
  user: {component: gain, rtpu: second, rate: 100 Hz, alias: {x: wanted, y: seen}, constants: {k: 1}}
configurations: {run: [reference, main, user]}
)";

class SteppedStandby : public ::testing::Test {
 protected:
  static bool await_seen(SteppedSubsystem& system, double value) {
    return system.until([&] { return system.value("seen") == value; }, seconds(5));
  }
  static Json takeovers(SteppedSubsystem& system) {
    Json found = Json::array();
    for (const Json& one : system.receipts())
      if (one["way"] == "takeover") found.push_back(one);
    return found;
  }
};

TEST_F(SteppedStandby, TakesOverFromAProcessThatDiesWithoutFlagAndWithoutALostCycle) {
  SteppedSubsystem system(kStandby);
  ASSERT_TRUE(system.until_started());
  ASSERT_TRUE(await_seen(system, 2));
  system.die("first");
  ASSERT_TRUE(system.until_on("spare"));
  ASSERT_TRUE(await_seen(system, 3));
  ASSERT_TRUE(system.until([&] { return system.state("main") == State::kOff; }));  // restarted, and it stays OFF
  EXPECT_EQ(system.result("status")["configuration"], "run with spare for main");
  EXPECT_NE(system.events("note").find("took over from 'main'"), std::string::npos) << system.events("note");
  ASSERT_EQ(takeovers(system).size(), 1u);
  const Json receipt = takeovers(system)[0];
  EXPECT_EQ(receipt["asked_by"],
            Json({{"reaction", "standby_for"}, {"lost", "main"}, {"by", "death"}, {"task", "spare"}}));
  EXPECT_EQ(receipt["number"], 1);
  EXPECT_EQ(receipt["end"], "done");
  EXPECT_EQ(receipt["flag_ns"], 0);
  for (const Json& task : receipt["tasks"]) EXPECT_EQ(task["lost"], 0) << task["task"];
  EXPECT_EQ(receipt["variables"][0]["step"], 1);
  EXPECT_EQ(system.events("flag"), "");
  EXPECT_FALSE(system.call("signal", {{"signal", "on"}, {"tasks", {"main"}}}).is_good());
  EXPECT_EQ(system.result("switch", {{"configuration", "run"}})["end"], "done");  // back, by a person
  EXPECT_TRUE(await_seen(system, 2));
  EXPECT_EQ(system.result("status")["configuration"], "run");
}

/// The rtpu of the primary and the manager die together, `later` steps of 100 us apart.
TEST_F(SteppedStandby, TakesOverWhileTheManagerIsDead) {
  for (int later = 0; later < 10; ++later) {
    SteppedSubsystem system(kStandby);
    ASSERT_TRUE(system.until_started());
    ASSERT_TRUE(await_seen(system, 2));
    system.die("first");
    system.run(microseconds(100) * later);
    system.kill_manager();
    system.run(milliseconds(100));
    EXPECT_EQ(system.rtpu("second").state(system.task("spare")), State::kOn) << later;
    system.start_manager();
    ASSERT_TRUE(system.until([&] { return system.state("main") == State::kOff; })) << later;
    ASSERT_EQ(takeovers(system).size(), 1u) << later;  // by the next manager
    EXPECT_EQ(takeovers(system)[0]["end"], "done") << later;
    EXPECT_TRUE(await_seen(system, 3)) << later;
  }
}

}  // namespace chimera::manager::standby_stepped_test
