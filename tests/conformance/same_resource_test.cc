// SPDX-License-Identifier: Apache-2.0
// Two tasks that open one device, on every executor of one context: the start leaves one of them NOT-CREATED, a switch
// closes the device for the one before it opens it for the other, a standby waits until it is closed, and `on` may take
// several cycles.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

/// The device of a run, and what happened to it. One run at a time.
struct Device {
  std::vector<std::string> story;
  std::string fails;      // the method that answers with a fault: "init drill"
  int users = 0;
  int not_ready = 0;      // number of times that `on` of the drill answers not yet
  int hand_not_ready = 0, arm_not_ready = 0;  // of the hand and of the arm
  std::uint64_t hand_fails_at = 0;  // cycle of the hand that is a fault; 0: none
  std::vector<std::string> configurations;  // that the arm saw in force, without repetitions
};
Device device;

Outcome tell(const std::string& what) {
  device.story.push_back(what);
  return device.fails == what ? fault("no") : ok();
}

Outcome open(const char* who) {
  const bool is_busy = ++device.users > 1;  // kill follows an init that fails
  const Outcome told = tell(std::string("init ") + who);
  return is_busy ? fault("the device is busy") : told;
}

Outcome close(const char* who) {
  --device.users;
  return tell(std::string("kill ") + who);
}

struct Hand {
  Out<double> force{"force", "N", initial = 0.0};
  Resource port{"port"};
  Outcome init(Cycle) { return open("hand"); }
  Outcome on(Cycle) {
    const Outcome told = tell("on hand");
    return device.hand_not_ready-- > 0 ? not_yet() : told;
  }
  Outcome cycle(Cycle c) {
    *force = 1;
    return device.hand_fails_at != 0 && c.count() == device.hand_fails_at ? fault("no current") : ok();
  }
  Outcome off(Cycle) { return tell("off hand"); }
  Outcome kill(Cycle) { return close("hand"); }
};

struct Drill {
  Out<double> force{"force", "N", initial = 0.0};
  Resource port{"port"};
  Outcome init(Cycle) { return open("drill"); }
  Outcome on(Cycle) {
    const Outcome told = tell("on drill");
    return device.not_ready-- > 0 ? not_yet() : told;
  }
  void cycle(Cycle) { *force = 2; }
  Outcome off(Cycle) { return tell("off drill"); }
  Outcome kill(Cycle) { return close("drill"); }
};

struct Arm {
  In<double> force{"force", "N"};
  Out<double> u{"u", "N", initial = 0.0};
  Outcome on(Cycle) { return device.arm_not_ready-- > 0 ? not_yet() : ok(); }
  void cycle(Cycle c) {
    *u = *force;
    const std::string now(c.configuration());
    if (device.configurations.empty() || device.configurations.back() != now) device.configurations.push_back(now);
  }
};

constexpr TaskId kHand{0u}, kDrill{1u}, kArm{2u};
constexpr std::uint32_t kWithHand = 0, kWithDrill = 1;
using Story = std::vector<std::string>;

class SameResource : public OneContext {
 protected:
  void SetUp() override { device = {}; }
  void describe(testing::TestApplication& app) override {
    app.add("hand", testing::component<Hand>("hand")).budget = microseconds(20);
    app.add("drill", testing::component<Drill>("drill"), drill_period_).budget = microseconds(20);
    app.add("arm", testing::component<Arm>("arm")).budget = microseconds(20);
    for (const TaskId tool : {kHand, kDrill}) {
      app.port(tool.index, 1).value = text_;
      app.port(tool.index, 1).shared = is_shared_;
    }
    app.make({kHand, kArm}, false);
    app.spec.sets = sets_;
    app.spec.standbys = standbys_;
  }
  /// Makes it anew; the start may be refused.
  Result<void> start(const std::vector<ScriptAct>& acts) {
    build(acts);
    return runner_->start();
  }
  Story states() const {
    Story all;
    for (const TaskId id : {kHand, kDrill, kArm}) all.emplace_back(state_name(state(id)));
    return all;
  }

  const std::vector<std::byte> text_ = testing::bytes_of("tty0");
  bool is_shared_ = false;
  Nanoseconds drill_period_ = milliseconds(1);  // as the others have it
  std::vector<TaskId> with_hand_{kHand, kArm}, with_drill_{kDrill, kArm};
  std::vector<StandbySpec> standbys_;
  NamedSet sets_[2] = {{"hand", with_hand_}, {"drill", with_drill_}};
};

INSTANTIATE_TEST_SUITE_P(All, SameResource, kEachExecutor, name_of_kind);

TEST_P(SameResource, ASwitchClosesTheDeviceBeforeItOpensItForTheOther) {
  const auto receipts = go(milliseconds(40), {to(kWithDrill, milliseconds(5)), to(kWithHand, milliseconds(25))});
  ASSERT_EQ(receipts.size(), 2u);
  for (const SwitchReceipt& receipt : receipts) {
    EXPECT_EQ(receipt.end, SwitchEnd::kDone) << static_cast<int>(receipt.why) << receipt.said.view();
    EXPECT_EQ(receipt.way.slow, kSlowForResource);
    EXPECT_GE(receipt.flag, Nanoseconds{});  // the methods of the twin take no time
  }
  EXPECT_EQ(receipts[0].way.absent, kDrill);
  EXPECT_EQ(receipts[0].way.rival, kHand);
  EXPECT_EQ(device.story, (Story{"init hand", "on hand", "off hand", "kill hand", "init drill", "on drill",  //
                                 "off drill", "kill drill", "init hand", "on hand"}));
  EXPECT_EQ(states(), (Story{"ON", "NOT-CREATED", "ON"}));
  EXPECT_EQ(device.configurations, (Story{"hand", "drill", "hand"})) << "each changes at the end of its slow switch";
  EXPECT_FALSE(set_->flag().is_up());
  EXPECT_EQ(set_->tasks()[kArm.index].profile.dropped, 0u);
}

TEST_P(SameResource, DeclaredSharedBothAreCreatedAndTheSwitchIsFast) {
  is_shared_ = true;
  device.users = -1;  // takes two
  const auto receipts = go(milliseconds(20), {to(kWithDrill, milliseconds(5))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[0].way.slow, 0);
  EXPECT_EQ(device.story, (Story{"init hand", "init drill", "on hand", "on drill", "off hand"}));
}

TEST_P(SameResource, AfterAFailedSwitchTheOldTaskHasItsDevice) {
  for (const char* fails : {"init drill", "on drill"}) {
    device = {};
    device.fails = fails;
    const auto receipts = go(milliseconds(40), {to(kWithDrill, milliseconds(5))});
    ASSERT_EQ(receipts[0].end, SwitchEnd::kAborted) << fails;
    EXPECT_EQ(receipts[0].task, kDrill);
    EXPECT_EQ(receipts[0].said.view(), "no");
    EXPECT_FALSE(receipts[0].not_back.is_valid());
    EXPECT_EQ(states(), (Story{"ON", "NOT-CREATED", "ON"})) << fails;
    EXPECT_EQ(device.users, 1);
    EXPECT_FALSE(set_->flag().is_up());
  }
  EXPECT_EQ(device.story, (Story{"init hand", "on hand", "off hand", "kill hand", "init drill", "on drill",  //
                                 "kill drill", "init hand", "on hand"}));
}

TEST_P(SameResource, ADeviceThatCannotBeOpenedAgainIsNamed) {
  device.fails = "on drill";
  device.hand_fails_at = 1'000'000;
  (void)start({to(kWithDrill, milliseconds(5))});
  device.fails = "init hand";  // from now on
  EXPECT_EQ(runner_->run(milliseconds(40)), RunEnd::kTime);
  EXPECT_EQ(runner_->receipts()[0].end, SwitchEnd::kDone) << "nothing failed on the way";
  device = {};
  (void)start({to(kWithDrill, milliseconds(5)), {milliseconds(6), ScriptAct::Kind::kRaiseFlag, Signal::kOn, TaskId()}});
  device.not_ready = 1'000'000;
  device.fails = "init hand";
  EXPECT_EQ(runner_->run(milliseconds(40)), RunEnd::kTime);
  const SwitchReceipt& receipt = runner_->receipts()[0];
  EXPECT_EQ(receipt.why, NoSwitch::kFlagRaised);
  EXPECT_EQ(receipt.not_back, kHand);
  EXPECT_EQ(states(), (Story{"NOT-CREATED", "NOT-CREATED", "ON"}));
  EXPECT_EQ(device.users, 0) << "the drill is ended, and its device closed";
}

TEST_P(SameResource, OnMayTakeSomeCycles) {
  device.not_ready = 3;
  const auto receipts = go(milliseconds(40), {to(kWithDrill, milliseconds(5))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone) << static_cast<int>(receipts[0].why);
  EXPECT_EQ(std::ranges::count(device.story, "on drill"), 4);
  EXPECT_GE(receipts[0].at - receipts[0].asked, milliseconds(2));
  EXPECT_EQ(std::ranges::count(device.story, "off drill"), 0);
}

TEST_P(SameResource, ADeviceThatIsNotReadyIsAskedOnceInAPeriodOfItsTask) {
  drill_period_ = milliseconds(10);  // the arm has an edge each millisecond
  device.not_ready = 3;
  const auto receipts = go(milliseconds(100), {to(kWithDrill, milliseconds(5))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone) << static_cast<int>(receipts[0].why);
  EXPECT_EQ(std::ranges::count(device.story, "on drill"), 4);
  EXPECT_GE(receipts[0].at - receipts[0].asked, milliseconds(30));
}

TEST_P(SameResource, OnThatIsNeverReadyIsTakenBackWithItsOff) {
  device.not_ready = 1'000'000;
  const auto receipts = go(seconds(11), {to(kWithDrill, milliseconds(5))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kNotReady);
  EXPECT_EQ(receipts[0].task, kDrill);
  EXPECT_EQ(states(), (Story{"ON", "NOT-CREATED", "ON"}));
  const Story end(device.story.end() - 4, device.story.end());
  EXPECT_EQ(end, (Story{"off drill", "kill drill", "init hand", "on hand"}));
}

TEST_P(SameResource, AFastSwitchToAnUnreadyDeviceBecomesSlow) {
  is_shared_ = true;
  device.users = -1;
  device.not_ready = 3;
  const auto receipts = go(milliseconds(40), {to(kWithDrill, milliseconds(5))});
  ASSERT_EQ(receipts.size(), 1u);
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone) << static_cast<int>(receipts[0].why);
  EXPECT_EQ(receipts[0].way.slow, kSlowForDevice);
  EXPECT_EQ(device.story, (Story{"init hand", "init drill", "on hand", "on drill", "off drill",  //
                                 "off hand", "on drill", "on drill", "on drill"}));
  EXPECT_EQ(states(), (Story{"OFF", "ON", "ON"}));
}

TEST_P(SameResource, OnTheWayBackADeviceHasItsTime) {
  device.fails = "on drill";
  (void)start({to(kWithDrill, milliseconds(5))});
  device.hand_not_ready = 3;
  EXPECT_EQ(runner_->run(milliseconds(40)), RunEnd::kTime);
  EXPECT_EQ(runner_->receipts()[0].end, SwitchEnd::kAborted);
  EXPECT_FALSE(runner_->receipts()[0].not_back.is_valid());
  EXPECT_EQ(states(), (Story{"ON", "NOT-CREATED", "ON"}));
}

// 6 s each: more together than one has.
TEST_P(SameResource, OnTheWayBackEachDeviceHasItsTime) {
  with_drill_ = {kDrill};
  sets_[1].order = with_drill_;
  device.fails = "on drill";
  (void)start({to(kWithDrill, milliseconds(5))});
  device.hand_not_ready = device.arm_not_ready = 6000;
  EXPECT_EQ(runner_->run(seconds(13)), RunEnd::kTime);
  EXPECT_EQ(runner_->receipts()[0].end, SwitchEnd::kAborted);
  EXPECT_FALSE(runner_->receipts()[0].not_back.is_valid());
  EXPECT_EQ(states(), (Story{"ON", "NOT-CREATED", "ON"}));
}

TEST_P(SameResource, TheStartWaitsForADeviceAndGivesItUpAfterTenSeconds) {
  device.hand_not_ready = 5;
  EXPECT_TRUE(start({}));
  EXPECT_EQ(states(), (Story{"ON", "NOT-CREATED", "ON"}));
  EXPECT_EQ(std::ranges::count(device.story, "on hand"), 6);
  device = {};
  device.hand_not_ready = 1'000'000;
  const Result<void> refused = start({});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.view(), "on: hand is not ready yet");
  EXPECT_EQ(device.story.back(), "off hand");
  EXPECT_EQ(states(), (Story{"OFF", "NOT-CREATED", "OFF"}));
}

TEST_P(SameResource, SpawnByHandIsRefusedWhileTheOtherTaskIsCreated) {
  const auto signal = [](Nanoseconds at, Signal which, TaskId task) {
    return ScriptAct{at, ScriptAct::Kind::kSignal, which, task};
  };
  go(milliseconds(20), {signal(milliseconds(2), Signal::kSpawn, kDrill)});
  EXPECT_EQ(state(kDrill), chimera::State::kNotCreated);
  EXPECT_EQ(set_->life().judge().find_rival(kDrill), kHand);
  device = {};
  go(milliseconds(20),
     {signal(milliseconds(2), Signal::kKill, kHand), signal(milliseconds(3), Signal::kSpawn, kDrill)});
  EXPECT_EQ(states(), (Story{"NOT-CREATED", "OFF", "ON"}));
}

TEST_P(SameResource, AStandbyTakesOverWhenTheDeviceIsClosed) {
  standbys_ = {{kHand, kDrill}};
  device.hand_fails_at = 5;
  go(milliseconds(20), {});
  EXPECT_EQ(device.story, (Story{"init hand", "on hand", "kill hand", "init drill", "on drill"}));
  EXPECT_EQ(states(), (Story{"NOT-CREATED", "ON", "ON"}));
  EXPECT_EQ(set_->tasks()[kDrill.index].profile.takeovers, 1u);
  EXPECT_STREQ(set_->tasks()[kHand.index].faults.note, "is killed: its resource goes to 'drill'");
  EXPECT_EQ(device.users, 1);
}

TEST_P(SameResource, AStandbyThatCannotOpenItIsRuledOut) {
  standbys_ = {{kHand, kDrill}};
  device.hand_fails_at = 5;
  device.fails = "init drill";
  go(milliseconds(20), {});
  EXPECT_EQ(states(), (Story{"NOT-CREATED", "NOT-CREATED", "ON"}));
  EXPECT_EQ(std::ranges::count(device.story, "init drill"), 1);
  EXPECT_TRUE(set_->flag().is_up());
}

}  // namespace
}  // namespace chimera::toy
