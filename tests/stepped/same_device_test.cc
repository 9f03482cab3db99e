// SPDX-License-Identifier: Apache-2.0
// Two tasks of two rtpus open one device that accepts one user: in a switch, and as primary and standby.
#include <gtest/gtest.h>

#include "tests/stepped/stepped_kills.h"

namespace chimera::manager::same_device_test {
namespace {

const std::string kDevice = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  hand: {component: t_lock, rtpu: first, rate: 1 kHz, resources: {device: LOCK}, constants: {value: 1}}
  drill: {component: t_lock, rtpu: second, rate: 1 kHz, resources: {device: LOCK}, constants: {value: 2, late: 3}}
  user: {component: gain, rtpu: second, rate: 1 kHz, alias: {x: y, y: seen}, constants: {k: 1}}
)";
const std::string kSwitch = "configurations: {with_hand: [hand, user], with_drill: [drill, user]}\nstart: with_hand\n";
const std::string kWithHand = "hand user ", kWithDrill = "drill user ";

/// The device: a file that is removed when the tests are over.
struct LockFile {
  ~LockFile() { ::unlink(path.c_str()); }
  const std::string path = ::testing::TempDir() + "chimera_" + std::to_string(::getpid()) + ".lock";
};
std::string with_device(std::string text) {
  static const LockFile lock;
  return replaced(replaced(std::move(text), "LOCK", lock.path), "LOCK", lock.path);
}
std::string with_standby(const std::string& text) {
  return with_device(replaced(text, "late: 3}", "late: 3}, standby_for: hand")) +
         "configurations: {run: [hand, user]}\n";
}
bool sees_hand(SteppedSubsystem& system) { return system.value("seen") == 1; }
bool sees_drill(SteppedSubsystem& system) { return system.value("seen") == 2; }
/// No task found the device with another user.
bool had_one_user(SteppedSubsystem& system) { return system.events("fault").find("another user") == std::string::npos; }

TEST(SteppedSameDevice, IsClosedBeforeItIsOpenedInASwitch) {
  SteppedSubsystem system(with_device(kDevice + kSwitch));
  ASSERT_TRUE(system.until_started());
  EXPECT_EQ(system.state("drill"), State::kNotCreated);
  const Json plan = system.result("plan", {{"configuration", "with_drill"}});
  EXPECT_EQ(plan["way"], "slow");
  EXPECT_EQ(plan["slow_because"], Json::array({"resource"}));
  EXPECT_EQ(plan["slow_why"], "task 'drill' is NOT-CREATED: task 'hand' has its resource");
  for (const char* target : {"with_drill", "with_hand", "with_drill"}) {
    const Json receipt = system.result("switch", {{"configuration", target}});
    EXPECT_EQ(receipt["end"], "done") << receipt;
    EXPECT_EQ(receipt["slow_because"], Json::array({"resource"}));
    EXPECT_GT(whole_at(receipt, "flag_ns"), 0);
    const bool is_drill = receipt["to"] == "with_drill";
    EXPECT_EQ(system.on(), is_drill ? kWithDrill : kWithHand);
    EXPECT_EQ(system.state(is_drill ? "hand" : "drill"), State::kNotCreated);
    EXPECT_TRUE(system.until([&] { return is_drill ? sees_drill(system) : sees_hand(system); }));
  }
  const control::RpcResponse refused =
      system.call("signal", {{"signal", "spawn"}, {"tasks", Json::array({"hand"})}});
  EXPECT_NE(refused.message.find("hand has the resource '"), std::string::npos) << refused.message;
  EXPECT_NE(refused.message.find("of drill, which is ON"), std::string::npos) << refused.message;
  EXPECT_NE(refused.message.find("chimera switch with_hand"), std::string::npos) << refused.message;
  EXPECT_TRUE(had_one_user(system));
}

TEST(SteppedSameDevice, TheStartWaitsForADeviceThatIsNotReady) {
  SteppedSubsystem system(
      with_device(replaced(kDevice, "constants: {value: 1}", "constants: {value: 1, late: 20}") + kSwitch));
  EXPECT_TRUE(system.until_started());
  EXPECT_EQ(system.on(), kWithHand);
}

TEST(SteppedSameDevice, AStandbyOpensItWhenTheProcessOfThePrimaryIsDead) {
  SteppedSubsystem system(with_standby(kDevice));
  ASSERT_TRUE(system.until_started());
  ASSERT_TRUE(system.until([&] { return sees_hand(system); }));
  system.die("first");
  EXPECT_TRUE(system.until([&] { return system.on() == kWithDrill && sees_drill(system); })) << system.on();
  EXPECT_TRUE(system.until([&] { return system.rtpu("first").segment.block.head().incarnation == 2; }));
  system.run(milliseconds(300));
  EXPECT_EQ(system.on(), kWithDrill);
  EXPECT_EQ(system.state("hand"), State::kNotCreated);
  EXPECT_EQ(system.result("switch", {{"configuration", "run"}})["end"], "done");
  EXPECT_TRUE(system.until([&] { return sees_hand(system); }));
  EXPECT_TRUE(had_one_user(system)) << system.events("fault");
}

TEST(SteppedSameDevice, AStandbyOpensItWhenThePrimaryIsInErrorAndKilled) {
  SteppedSubsystem system(
      with_standby(replaced(kDevice, "constants: {value: 1}", "constants: {value: 1, fails_at: 30}")));
  EXPECT_TRUE(system.until([&] { return system.on() == kWithDrill && sees_drill(system); })) << system.on();
  EXPECT_EQ(system.state("hand"), State::kNotCreated);
  EXPECT_TRUE(had_one_user(system)) << system.events("fault");
}

/// `init` of the arriving task does not return. The rtpu is ended, and all refusals until then say what helps at once.
TEST(SteppedSameDevice, ASwitchWhoseInitHangsEndsWithTheSetBefore) {
  SteppedSubsystem system(with_device(kDevice + kSwitch));
  ASSERT_TRUE(system.until_started());
  system.hang_service("second");
  const PendingAnswer answer = system.ask("switch", {{"configuration", "with_drill"}, {"wait_ms", 1000}});
  system.run(seconds(4));
  const std::pair<const char*, Json> refused[] = {
      {"signal", {{"signal", "on"}, {"tasks", Json::array({"hand"})}}},
      {"switch", {{"configuration", "with_hand"}}},
      {"cancel", Json::object()},
      {"drill", Json::object()}};
  const std::string kill =
      "`kill -KILL " + std::to_string(::getpid()) + "` restarts rtpu second, which hangs: drill.init";
  for (const auto& [method, parameters] : refused) {
    const std::string remedy = system.call(method, parameters).detail("remedy");
    EXPECT_EQ(remedy.find(kill), 0u) << method << ": " << remedy;
  }
  EXPECT_FALSE(answer->has_value());
  ASSERT_TRUE(system.until([&] { return answer->has_value(); }, seconds(10)));
  const Json receipt = SteppedSubsystem::result_of(**answer);
  EXPECT_EQ(receipt["end"], "aborted");
  EXPECT_EQ(receipt["reason"], "no-answer");
  EXPECT_TRUE(system.until([&] { return system.on() == kWithHand && !system.flag(); })) << system.on();
  EXPECT_NE(system.events("rtpu-ended").find("it held up switch 1: drill.init"), std::string::npos)
      << system.events("rtpu-ended");
  EXPECT_EQ(system.switch_to("with_drill")["end"], "done");
}

class SteppedSameDeviceKills : public ::testing::TestWithParam<std::vector<std::string>> {};

TEST_P(SteppedSameDeviceKills, AtEveryStepOfASwitchLeaveItWithOneUser) {
  KillsInASwitch{with_device(kDevice + kSwitch), {"with_hand", kWithHand, sees_hand},
                 {"with_drill", kWithDrill, sees_drill}}
      .at_every_step(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Of, SteppedSameDeviceKills, ::testing::ValuesIn(kMishaps));
INSTANTIATE_TEST_SUITE_P(Services, SteppedSameDeviceKills,
                         ::testing::Values(std::vector<std::string>{"service first"},
                                           std::vector<std::string>{"service second"}));

}  // namespace
}  // namespace chimera::manager::same_device_test
