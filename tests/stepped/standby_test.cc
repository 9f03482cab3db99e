// SPDX-License-Identifier: Apache-2.0
// A standby takes over, whichever process dies and at every step, with and without a manager.
#include <gtest/gtest.h>

#include "chimera/base/hosted/wording.h"
#include "tests/stepped/stepped_subsystem.h"

namespace chimera::manager::standby_test {
namespace {

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
  static std::string with(const std::string& what, const std::string& instead) {
    return replaced(kStandby, what, instead);
  }
  static void end(SteppedSubsystem& system, const std::string& name) {
    if (name == "manager") system.kill_manager();
    else if (name.starts_with("SIGTERM ")) system.terminate(name.substr(8));
    else system.die(name);
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
  ASSERT_TRUE(system.until([&] { return takeovers(system).size() == 1; }));
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

/// The task asks in each cycle for the configuration of the primary, then for another one that has it.
TEST_F(SteppedStandby, ARequestOfATaskDoesNotGoBackToThePrimary) {
  SteppedSubsystem system(with("configurations: {run: [reference, main, user]}", R"(  asker:
    {component: t_asker, rtpu: second, rate: 100 Hz, constants: {first: run, second: less}}
operator: {wish: 1}
configurations: {run: [reference, main, user, asker], less: [reference, main, asker]}
start: run)"));
  ASSERT_TRUE(system.until_started());
  system.die("first");
  ASSERT_TRUE(system.until_on("spare"));
  ASSERT_TRUE(system.until([&] { return system.state("main") == State::kOff; }));
  system.run(milliseconds(500));
  EXPECT_EQ(system.on(), "reference spare user asker ");
  EXPECT_EQ(system.receipts().size(), 1u) << "of the takeover";
  system.set("wish", 2);
  ASSERT_TRUE(system.until([&] { return system.on() == "reference spare asker "; })) << system.on();
  ASSERT_TRUE(system.until([&] { return system.receipts().size() == 2; }));
  EXPECT_EQ(system.receipts().elements()[1]["from"], "run with spare for main");
  const Json status = system.status(), taken = takeovers(system)[0];
  const std::int64_t asked = taken["asked_ns"].as_int64() + status["origin_ns"].as_int64();
  const double since_start = static_cast<double>(asked - status["started_ns"].as_int64()) / 1e9;
  EXPECT_NE(system.events("switch").find(formatted("takeover 1 at %.3f s by 'spare'", since_start)), std::string::npos)
      << system.events("switch");
  EXPECT_EQ(system.result("switch", {{"configuration", "run"}})["end"], "done") << "a person may";
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

/// The producer of the standby's input dies with the primary. It comes back ON, the primary stays OFF.
TEST_F(SteppedStandby, TakesOverWithAnInputThatDiesWithThePrimary) {
  SteppedSubsystem system(with("signal_generator, rtpu: second", "signal_generator, rtpu: first"));
  ASSERT_TRUE(system.until_started());
  ASSERT_TRUE(await_seen(system, 2));
  system.die("first");
  ASSERT_TRUE(system.until_on("spare"));
  ASSERT_TRUE(system.until_on("reference"));
  EXPECT_TRUE(system.until([&] { return system.state("main") == State::kOff; }));
  EXPECT_TRUE(system.until([&] { return !system.flag(); }));
  EXPECT_TRUE(await_seen(system, 3));
}

TEST_F(SteppedStandby, IsReplacedByThePrimaryWhenItDies) {
  SteppedSubsystem system(kStandby);
  ASSERT_TRUE(system.until_started());
  system.die("first");
  ASSERT_TRUE(system.until_on("spare"));
  ASSERT_TRUE(system.until([&] { return system.state("main") == State::kOff; }));
  system.die("second");
  ASSERT_TRUE(system.until_on("main"));
  ASSERT_TRUE(system.until_on("user"));
  EXPECT_TRUE(await_seen(system, 2));
  ASSERT_TRUE(system.until([&] { return takeovers(system).size() == 2; }));
  EXPECT_EQ(takeovers(system)[0]["asked_by"]["task"], "spare");
  EXPECT_EQ(takeovers(system)[1]["asked_by"]["task"], "main");
  EXPECT_EQ(system.state("spare"), State::kOff);
}

TEST_F(SteppedStandby, CyclesUnreadBesideThePrimaryIfItIsHot) {
  SteppedSubsystem system(with("standby_for: main", "standby_for: {task: main, hot: true}"));
  ASSERT_TRUE(system.until_started());
  const auto cycles = [&] { return system.profile("spare").cycles; };
  ASSERT_TRUE(system.until([&] { return cycles() > 10; }));
  EXPECT_TRUE(await_seen(system, 2));
  EXPECT_EQ(system.state("spare"), State::kOff);
  EXPECT_EQ(system.status()["configuration"], "run");
  system.kill_manager();
  system.die("first");
  system.run(milliseconds(50));
  system.start_manager();
  ASSERT_TRUE(system.until([&] { return system.state("main") == State::kOff; }));
  EXPECT_TRUE(await_seen(system, 3));
  EXPECT_EQ(system.events("flag"), "");
  EXPECT_EQ(system.switch_to("run")["end"], "done");
  EXPECT_TRUE(await_seen(system, 2));
  const std::uint64_t before = cycles();
  EXPECT_TRUE(system.until([&] { return cycles() > before + 5; }));
  EXPECT_EQ(system.state("spare"), State::kOff);
}

// The reader in the second rtpu sees that the value from the first is too old.
const std::string kStale = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  live:
    {component: signal_generator, rtpu: first, rate: 100 Hz, alias: {y: x},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  reader: {component: t_ages, rtpu: second, rate: 100 Hz, stale_after: 100 ms}
configurations: {all: [live, reader]}
start: all
)";

TEST_F(SteppedStandby, AnInputThatIsTooOldIsNotValidUntilItsProducerGoesOnOrComesBack) {
  SteppedSubsystem system(kStale);
  ASSERT_TRUE(system.until_started());
  const auto valid = [&] {
    return system.result("get", {{"variables", Json::array({"valid"})}})["values"]["valid"]["value"].as_bool();
  };
  ASSERT_TRUE(system.until(valid));
  system.stop("first", true);
  ASSERT_TRUE(system.until([&] { return !valid(); }));
  system.stop("first", false);
  ASSERT_TRUE(system.until(valid));
  system.die("first");
  ASSERT_TRUE(system.until_on("live"));
  EXPECT_TRUE(system.until(valid));
  EXPECT_EQ(system.state("reader"), State::kOn);
}

/// One or two of rtpus and manager die, the second one at each step of the takeover from the first.
TEST_F(SteppedStandby, ExactlyOneTaskIsOnAfterAnyTwoDeaths) {
  const std::string names[] = {"first", "second", "manager", "SIGTERM first", "SIGTERM second"};
  for (const std::string& one : names) {
    for (const std::string& other : names) {
      if (one.ends_with(other) || other.ends_with(one)) continue;
      for (int steps = 0; steps < 12; ++steps) {
        SteppedSubsystem system(kStandby);
        ASSERT_TRUE(system.until_started());
        ASSERT_TRUE(await_seen(system, 2));
        end(system, one);
        system.run(microseconds(400) * steps);
        end(system, other);
        system.run(milliseconds(10));
        if (one == "manager" || other == "manager") system.start_manager();
        const auto is_settled = [&] {
          const bool main = system.state("main") == State::kOn, spare = system.state("spare") == State::kOn;
          return main != spare && system.state("user") == State::kOn && system.state("reference") == State::kOn;
        };
        ASSERT_TRUE(system.until(is_settled)) << one << " " << other << " " << steps << ": " << system.on();
        system.run(milliseconds(200));
        EXPECT_TRUE(is_settled()) << one << " " << other << " " << steps << ": " << system.on();
        EXPECT_EQ(system.value("seen"), system.state("main") == State::kOn ? 2 : 3) << one << other << steps;
      }
    }
  }
}

}  // namespace
}  // namespace chimera::manager::standby_test
