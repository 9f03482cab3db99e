// SPDX-License-Identifier: Apache-2.0
// The slow switch on every executor of one context: constants of two tools that change under a task that stays, the
// flag during the switch, and the way back from each step.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/runner.h"

namespace chimera::toy::slow_switch_test {
namespace {

/// Actions of the components of a run, and the values that they read. One run at a time.
struct Tools {
  std::vector<std::string> story;
  std::string fails;          // the method that answers with a fault: "on heavy"
  double heavy = 3;           // mass of the tool heavy
  std::int32_t heavy_axes = 2;
  std::vector<std::pair<std::int64_t, bool>> arm;  // release, flag
  std::vector<double> weighed;                     // by the cycles of the arm
  std::vector<std::uint32_t> axes;
};
Tools tools;

Outcome tell(const char* what) {
  tools.story.emplace_back(what);
  if (tools.fails == what) return fault("no");
  return ok();
}

struct Light {
  OutConst<double> mass{"mass", "kg"};
  OutConst<std::int32_t> axes{"axes", "1"};
  Out<double> grip{"grip", "1", initial = 0.0};
  void init(Cycle) { *mass = 1, *axes = 2; }
  Outcome on(Cycle) { return tell("on light"); }
  void cycle(Cycle) { *grip = 1; }
  Outcome off(Cycle) { return tell("off light"); }
};

struct Heavy {
  OutConst<double> mass{"mass", "kg"};
  OutConst<std::int32_t> axes{"axes", "1"};
  Out<double> grip{"grip", "1", initial = 0.0};
  void init(Cycle) { *mass = tools.heavy, *axes = tools.heavy_axes; }
  Outcome on(Cycle) { return tell("on heavy"); }
  void cycle(Cycle) { *grip = 2; }
  Outcome off(Cycle) { return tell("off heavy"); }
};

struct Arm {  // stays; a device
  InConst<double> mass{"mass", "kg"};
  In<double> grip{"grip", "1"};
  Out<double> force{"force", "N", initial = 0.0};
  OutConst<double> load{"load", "kg"};
  Resource link{"link"};
  void init(Cycle) { *load = *mass * 10; }
  Outcome reinit(Cycle) {
    *load = *mass * 10;
    return tell("reinit arm");
  }
  void cycle(Cycle c) {
    tools.arm.emplace_back(c.now().count, c.illegal());
    tools.weighed.push_back(*mass);
    *force = *mass;
  }
};

struct Law {  // uses what arm makes of it
  InConst<double> load{"load", "kg"};
  In<double> force{"force", "N"};
  Out<double> u{"u", "N", initial = 0.0};
  Outcome reinit(Cycle) { return tell("reinit law"); }
  void cycle(Cycle) { *u = *load; }
};

struct Screen {  // has as many bars as there are axes, and no port for that number
  Out<double[]> bars{"bars", "1", "[axes<=4]", initial = 0.0};
  Outcome reinit(Cycle) { return tell("reinit screen"); }
  void cycle(Cycle) { tools.axes.push_back(static_cast<std::uint32_t>(bars.size())); }
};

struct Bystander {
  Out<double> b{"b", "1", initial = 0.0};
  Outcome reinit(Cycle) { return tell("reinit bystander"); }
  void cycle(Cycle) { *b = *b + 1; }
};

constexpr TaskId kLight{0u}, kHeavy{1u}, kArm{2u}, kLaw{3u}, kScreen{4u}, kBystander{5u};
constexpr std::uint32_t kWithLight = 0, kWithHeavy = 1, kWithout = 2;

class SlowSwitches : public ::testing::TestWithParam<Kind> {
 protected:
  void SetUp() override { tools = {}; }
  std::span<const SwitchReceipt> go(Nanoseconds duration, const std::vector<ScriptAct>& acts) {
    acts_ = acts;
    runner_.reset();
    set_.reset();
    app_ = std::make_unique<testing::TestApplication>();
    const auto add = [&](const char* name, const chimera_component* what, std::int64_t ms = 1) {
      app_->add(name, what, milliseconds(ms)).budget = microseconds(20);
    };
    add("light", testing::component<Light>("light"));
    add("heavy", testing::component<Heavy>("heavy"));
    add("arm", testing::component<Arm>("arm"), 4);
    add("law", testing::component<Law>("law"));
    add("screen", testing::component<Screen>("screen"));
    add("bystander", testing::component<Bystander>("bystander"));
    app_->extend(kScreen.index, 0, 4, "axes");
    app_->make({kLight, kArm, kLaw, kScreen, kBystander}, false);
    app_->spec.sets = sets_;
    set_ = *HeapTaskSet::create(app_->spec, app_->components);
    runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
    EXPECT_TRUE(runner_->start());
    EXPECT_EQ(runner_->run(duration), RunEnd::kTime);
    return runner_->receipts();
  }
  static ScriptAct to(std::uint32_t set, Nanoseconds at) {
    ScriptAct act;
    act.at = at;
    act.kind = ScriptAct::Kind::kSwitch;
    act.set = set;
    return act;
  }
  bool are_on(const std::vector<TaskId>& tasks) const {
    for (const Task& task : set_->tasks())
      if ((task.state == chimera::State::kOn) != (std::ranges::find(tasks, task.id) != tasks.end())) return false;
    return true;
  }
  std::vector<TaskId> with_light_{kLight, kArm, kLaw, kScreen, kBystander};
  std::vector<TaskId> with_heavy_{kHeavy, kArm, kLaw, kScreen, kBystander}, without_{kBystander};
  NamedSet sets_[3] = {{"light", with_light_}, {"heavy", with_heavy_}, {"without", without_}};
  std::vector<ScriptAct> acts_;
  std::unique_ptr<testing::TestApplication> app_;
  std::unique_ptr<HeapTaskSet> set_;
  std::unique_ptr<Runner> runner_;
};

INSTANTIATE_TEST_SUITE_P(All, SlowSwitches,
                         ::testing::Values(Kind::kExecutiveOnTwin, Kind::kVirtual, Kind::kPreemptive),
                         [](const auto& one) { return kind_name(one.param); });

TEST_P(SlowSwitches, UsersThatStayAreReinitialisedInOrderUnderTheFlag) {
  const auto receipts = go(milliseconds(40), {to(kWithHeavy, microseconds(9600))});
  ASSERT_EQ(receipts.size(), 1u);
  const SwitchReceipt& receipt = receipts[0];
  ASSERT_EQ(receipt.end, SwitchEnd::kDone) << static_cast<int>(receipt.why);
  EXPECT_EQ(receipt.way.slow, kSlowForConstants);
  EXPECT_EQ(receipt.way.constant.task, kArm);
  EXPECT_EQ(tools.story, (std::vector<std::string>{"on light", "off light", "reinit arm", "reinit law", "on heavy"}));
  EXPECT_EQ((std::vector<TaskId>{receipt.reinitialised.begin(), receipt.reinitialised.end()}),
            (std::vector<TaskId>{kArm, kLaw}));
  EXPECT_TRUE(are_on(with_heavy_));
  EXPECT_FALSE(set_->flag().is_up());
  EXPECT_GE(receipt.flag, milliseconds(4)) << "the arm has acted on it";
  EXPECT_LE(receipt.flag, receipt.at - receipt.asked + microseconds(1));
  EXPECT_EQ(tools.weighed.front(), 1);
  EXPECT_EQ(tools.weighed.back(), 3);
  for (std::size_t i = 1; i < tools.arm.size(); ++i) {  // with the old value it has seen the flag before the new one
    const bool is_new = tools.weighed[i] != tools.weighed[i - 1];
    EXPECT_TRUE(!is_new || tools.arm[i - 1].second) << i;
  }
}

TEST_P(SlowSwitches, EqualBytesOrNoUserThatStaysAreFast) {
  tools.heavy = 1;
  auto receipts = go(milliseconds(40), {to(kWithHeavy, milliseconds(5))});
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[0].way.slow, 0);
  EXPECT_EQ(receipts[0].flag, Nanoseconds{});
  EXPECT_TRUE(receipts[0].reinitialised.empty());
  tools = {};
  receipts = go(milliseconds(40), {to(kWithout, milliseconds(5)), to(kWithHeavy, milliseconds(15))});
  ASSERT_EQ(receipts[1].end, SwitchEnd::kDone) << static_cast<int>(receipts[1].why);
  EXPECT_EQ(receipts[1].way.slow, 0);
  EXPECT_EQ((std::vector<TaskId>{receipts[1].reinitialised.begin(), receipts[1].reinitialised.end()}),
            (std::vector<TaskId>{kArm, kLaw})) << "arriving tasks have the constants of the set, too";
  EXPECT_EQ(tools.weighed.back(), 3);
}

TEST_P(SlowSwitches, AnExtentMayChangeWithinItsMaximum) {
  tools.heavy = 1;
  tools.heavy_axes = 3;
  const auto receipts = go(milliseconds(60), {to(kWithHeavy, milliseconds(5)), to(kWithLight, milliseconds(30))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[0].way.slow, kSlowForConstants);
  ASSERT_EQ(receipts[0].reinitialised.size(), 1u);
  EXPECT_EQ(receipts[0].reinitialised[0], kScreen);
  EXPECT_EQ(tools.axes.front(), 2u);
  EXPECT_EQ(*std::ranges::max_element(tools.axes), 3u);
  EXPECT_EQ(tools.axes.back(), 2u) << "and back";
}

TEST_P(SlowSwitches, AnExtentBeyondItsMaximumIsFoundBeforeAnythingHappens) {
  tools.heavy_axes = 5;
  const auto receipts = go(milliseconds(40), {to(kWithHeavy, milliseconds(5))});
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kBadConstant);
  EXPECT_EQ(receipts[0].task, kScreen);
  EXPECT_EQ(receipts[0].said.view(), "extent axes = 5 of port bars is outside 1 to 4");
  EXPECT_EQ(receipts[0].flag, Nanoseconds{});
  EXPECT_EQ(tools.story, (std::vector<std::string>{"on light"}));
  for (const auto& [release, flag] : tools.arm) EXPECT_FALSE(flag) << release;
  EXPECT_TRUE(are_on(with_light_));
}

// Each step fails once.
TEST_P(SlowSwitches, AFailureInAnyStepRestoresTasksAndConstants) {
  struct Case {
    const char* fails;
    std::vector<std::string> story;
    bool is_back = true;
  };
  const std::vector<Case> cases = {
      {"off light", {}, false},
      {"reinit arm", {}, false},
      {"reinit law", {}, false},
      {"on heavy",
       {"on light", "off light", "reinit arm", "reinit law", "on heavy", "reinit arm", "reinit law", "on light"}},
  };
  for (const Case& each : cases) {
    tools = {};
    tools.fails = each.fails;
    const auto receipts = go(milliseconds(40), {to(kWithHeavy, milliseconds(5))});
    ASSERT_EQ(receipts[0].end, SwitchEnd::kAborted) << each.fails;
    EXPECT_EQ(receipts[0].said.view(), "no");
    EXPECT_EQ(receipts[0].way.slow, kSlowForConstants);
    if (!each.is_back) continue;  // the default `error` leads to ERROR, which a test below checks
    EXPECT_EQ(tools.story, each.story) << each.fails;
    EXPECT_FALSE(receipts[0].not_back.is_valid());
    EXPECT_TRUE(are_on(with_light_)) << each.fails;
    EXPECT_FALSE(set_->flag().is_up());
    EXPECT_EQ(tools.weighed.back(), 1);
  }
}

TEST_P(SlowSwitches, NamesATaskThatDoesNotComeBack) {
  tools.fails = "reinit arm";
  const auto receipts = go(milliseconds(40), {to(kWithHeavy, milliseconds(5))});
  EXPECT_EQ(receipts[0].why, NoSwitch::kStepFailed);
  EXPECT_EQ(receipts[0].task, kArm);
  EXPECT_EQ(receipts[0].not_back, kArm);
  EXPECT_EQ(set_->tasks()[kLight.index].state, chimera::State::kOn);
  EXPECT_TRUE(set_->flag().is_up()) << "no task produces force";
}

TEST_P(SlowSwitches, ASignalToAMemberAndTheFlagTakeItBack) {
  const ScriptAct off{milliseconds(11), ScriptAct::Kind::kSignal, Signal::kOff, kBystander};
  auto receipts = go(milliseconds(40), {to(kWithHeavy, microseconds(9600)), off});  // the flag is up for the arm to act
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kDisturbed);
  EXPECT_EQ(receipts[0].task, kBystander);
  EXPECT_EQ(receipts[0].not_back, kBystander);
  EXPECT_EQ(tools.story, (std::vector<std::string>{"on light"}));
  EXPECT_FALSE(set_->flag().is_up());
  tools = {};
  const ScriptAct up{milliseconds(11), ScriptAct::Kind::kRaiseFlag, Signal::kOn, TaskId()};
  receipts = go(milliseconds(40), {to(kWithHeavy, microseconds(9600)), up});
  EXPECT_EQ(receipts[0].why, NoSwitch::kFlagRaised);
  EXPECT_FALSE(receipts[0].not_back.is_valid());
  EXPECT_TRUE(set_->flag().is_up());
  EXPECT_TRUE(are_on(with_light_));
}

// Outside the configuration in force a task has the constants of the first one that names it.
TEST_P(SlowSwitches, OnByHandReinitialisesATaskWithOtherConstants) {
  tools.heavy = 1;
  tools.heavy_axes = 3;
  const ScriptAct off{milliseconds(25), ScriptAct::Kind::kSignal, Signal::kOff, kScreen};
  const ScriptAct on{milliseconds(45), ScriptAct::Kind::kSignal, Signal::kOn, kScreen};
  const auto receipts =
      go(milliseconds(60), {to(kWithHeavy, milliseconds(5)), off, to(kWithout, milliseconds(30)), on});
  ASSERT_EQ(receipts[1].end, SwitchEnd::kDone) << static_cast<int>(receipts[1].why);
  EXPECT_EQ(std::ranges::count(tools.story, "reinit screen"), 2);
  EXPECT_EQ(*std::ranges::max_element(tools.axes), 3u);
  EXPECT_EQ(tools.axes.back(), 2u);
}

TEST_P(SlowSwitches, ThereAndBackAThousandTimesLeavesNothing) {
  std::vector<ScriptAct> acts;
  Nanoseconds at = milliseconds(3);
  for (std::uint32_t i = 0; i < 1000; ++i, at += microseconds(20'137)) acts.push_back(to(i % 2 == 0 ? 1 : 0, at));
  const auto receipts = go(at + milliseconds(20), acts);
  ASSERT_EQ(receipts.size(), 1000u);
  for (const SwitchReceipt& receipt : receipts) {
    ASSERT_EQ(receipt.end, SwitchEnd::kDone) << receipt.number << " " << static_cast<int>(receipt.why);
    ASSERT_EQ(receipt.reinitialised.size(), 2u);
  }
  EXPECT_TRUE(are_on(with_light_));
  EXPECT_FALSE(set_->flag().is_up());
  EXPECT_EQ(set_->tasks()[kBystander.index].profile.dropped, 0u);
}

}  // namespace
}  // namespace chimera::toy::slow_switch_test
