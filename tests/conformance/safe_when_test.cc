// SPDX-License-Identifier: Apache-2.0
// A switch waits until `safe_when` of its configuration holds and until the inputs of arriving tasks have values: on
// every executor of one context, and over several rtpus in virtual time, where the value comes from the other rtpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"
#include "tests/conformance/runner.h"

namespace chimera::toy::safe_when_test {
namespace {

/// Actions of the components of a run. One run at a time.
struct Scene {
  std::function<double(std::uint64_t)> speed;  // by cycle
  std::function<void(Cycle)> on_of_hand;
  int cycles = 0;  // of plant
  double late_at_on = 0;
};
Scene scene;

struct Plant {
  In<double> u{"u", "1"};
  Out<double> speed{"speed", "rad/s"};
  Out<std::int32_t[3]> axes{"axes", "1", initial = 0};
  Out<bool> closed{"closed", "1", initial = false};
  void cycle(Cycle c) {
    *speed = scene.speed(c.count());
    axes[1] = static_cast<std::int32_t>(c.count());
    *closed = c.count() >= 7;
    ++scene.cycles;
  }
};

struct Auto {
  Out<double> u{"u", "1", initial = 0.0};
  Out<double> only_here{"only_here", "1", initial = 0.0};
  void cycle(Cycle) { *u = 1; }
};

struct Hand {
  Out<double> u{"u", "1", initial = 0.0};
  void on(Cycle c) {
    if (scene.on_of_hand) scene.on_of_hand(c);
  }
  void cycle(Cycle) { *u = 2; }
};

struct Third {
  Out<double> third{"third", "1", initial = 0.0};
  void cycle(Cycle) { *third = 1; }
};

struct Late {
  Out<double> late{"late", "1"};
  void cycle(Cycle) { *late = 3; }
};

struct Remote {
  In<double> late{"late", "1"};
  Out<double> u{"u", "1", initial = 0.0};
  void on() { scene.late_at_on = *late; }
  void cycle(Cycle) { *u = *late; }
};

constexpr TaskId kPlant{0u}, kAuto{1u}, kHand{2u}, kThird{3u}, kLate{4u}, kRemote{5u};
constexpr std::uint32_t kToHand = 1, kToRemote = 2;

struct Asked {
  const char* variable;
  std::uint32_t element;
  Relation comparison;
  double limit;
};

/// The tasks on two rtpus, or all in one context. A switch to 'hand' may happen when `asked` holds, a switch to
/// 'remote' when the task late has cycled, from its offset on.
struct Application {
  Application(const Asked& asked, Nanoseconds offset_of_late) {
    app.rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    app.add("plant", testing::component<Plant>("plant")).budget = microseconds(20);
    app.add("auto", testing::component<Auto>("auto")).budget = microseconds(20);
    app.add("hand", testing::component<Hand>("hand")).budget = microseconds(20);
    app.add("third", testing::component<Third>("third")).budget = microseconds(20);
    app.tasks[kPlant.index].rtpu = app.tasks[kAuto.index].rtpu = RtpuId{0u};
    TaskSpec& late = app.add("late", testing::component<Late>("late"), seconds(100));
    late.budget = microseconds(20);
    late.offset = offset_of_late;
    late.rtpu = RtpuId{0u};
    app.add("remote", testing::component<Remote>("remote")).budget = microseconds(20);
    app.tasks[kHand.index].rtpu = app.tasks[kThird.index].rtpu = app.tasks[kRemote.index].rtpu = RtpuId{1u};
    app.port(kPlant.index, 2).extent[0].max = 3;
    app.make({kPlant, kAuto, kLate}, false);
    const std::size_t variable = Variables(app.spec).find(asked.variable);
    EXPECT_LT(variable, app.spec.variables.size());
    sets[1].safe_when = {VariableId(variable), asked.element, asked.comparison, asked.limit};
    app.spec.sets = sets;
  }
  testing::TestApplication app;
  TaskId automatic[3] = {kPlant, kAuto, kLate}, hand[3] = {kPlant, kHand, kLate}, remote[3] = {kPlant, kLate, kRemote};
  NamedSet sets[3] = {{"automatic", automatic}, {"hand", hand}, {"remote", remote}};
};

ScriptAct switch_to(std::uint32_t set, Nanoseconds at) {
  ScriptAct act;
  act.at = at;
  act.kind = ScriptAct::Kind::kSwitch;
  act.set = set;
  return act;
}

enum class How { kExecutive, kVirtual, kPreemptive, kTwoRtpus, kTwoPreemptiveRtpus };

const char* name_of(How how) {
  const char* const names[] = {"executive", "virtual", "preemptive", "two_rtpus", "two_preemptive_rtpus"};
  return names[static_cast<int>(how)];
}

class SafeWhen : public ::testing::TestWithParam<How> {
 protected:
  SafeWhen() {
    scene = {};
    scene.speed = [](std::uint64_t cycle) { return 10.0 - static_cast<double>(cycle); };
  }
  SwitchReceipt go(const Asked& asked, Nanoseconds duration, Nanoseconds at = microseconds(2500)) {
    application_ = std::make_unique<Application>(asked, milliseconds(6));
    return go_to(kToHand, duration, at);
  }
  /// The task late has its first cycle at `first`.
  SwitchReceipt go_to_remote(Nanoseconds first, Nanoseconds duration) {
    application_ = std::make_unique<Application>(Asked{"speed", 0, Relation::kUnequal, 100}, first);
    return go_to(kToRemote, duration, microseconds(2500));
  }
  SwitchReceipt go_to(std::uint32_t to, Nanoseconds duration, Nanoseconds at) {
    testing::TestApplication& app = application_->app;
    std::vector<ScriptAct> acts = signals_;
    acts.push_back(switch_to(to, at));
    std::ranges::stable_sort(acts, {}, &ScriptAct::at);
    if (GetParam() >= How::kTwoRtpus) return go_on_two(app, acts, duration);
    auto set = *HeapTaskSet::create(app.spec, app.components);
    Runner runner(*set, static_cast<Kind>(GetParam()), Policy::kEdf, acts);
    EXPECT_TRUE(runner.start());
    EXPECT_EQ(runner.run(duration), RunEnd::kTime);
    look(set->tasks()[kAuto.index], runner.refused());
    runner.shut_down();
    return runner.receipts()[0];
  }
  SwitchReceipt go_on_two(testing::TestApplication& app, std::span<const ScriptAct> acts, Nanoseconds duration) {
    auto peers = *VirtualPeers::create(app.spec);
    std::vector<std::unique_ptr<HeapTaskSet>> sets;
    for (std::uint32_t r = 0; r < 2; ++r) {
      ContextPlace place;
      place.rtpu = RtpuId(r);
      place.others = peers.get();
      sets.push_back(*HeapTaskSet::create(app.spec, app.components, place));
      peers->join(RtpuId(r), *sets.back());
    }
    RunOptions options;
    options.script = Script(acts);
    VirtualOptions how;
    how.preemptive = GetParam() == How::kTwoPreemptiveRtpus;
    VirtualRtpus run(*peers, options, how);
    EXPECT_TRUE(run.start());
    EXPECT_EQ(run.run(duration), RunEnd::kTime);
    look(sets[0]->tasks()[kAuto.index], run.refused());
    run.shut_down();
    return run.receipts().all()[0];
  }
  void look(const Task& automatic, std::span<const RefusedSignal> refused) {
    state_of_auto_ = automatic.state;
    refused_.assign(refused.begin(), refused.end());
  }
  std::unique_ptr<Application> application_;
  std::vector<ScriptAct> signals_;
  // At the end of the run.
  chimera::State state_of_auto_ = chimera::State::kNotCreated;
  std::vector<RefusedSignal> refused_;
};

INSTANTIATE_TEST_SUITE_P(All, SafeWhen,
                         ::testing::Values(How::kExecutive, How::kVirtual, How::kPreemptive, How::kTwoRtpus,
                                           How::kTwoPreemptiveRtpus),
                         [](const auto& one) { return name_of(one.param); });

TEST_P(SafeWhen, HoldsArmingUpUntilItIsTrue) {
  const SwitchReceipt receipt = go({"speed", 0, Relation::kLess, 4.5}, milliseconds(20));
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_GE(receipt.armed, milliseconds(6));  // the cycle of 6 ms publishes 4
  EXPECT_LE(receipt.armed, milliseconds(7));
}

TEST_P(SafeWhen, KeepsAnotherProducerOutWhileItIsWaitedFor) {
  signals_ = {{milliseconds(1), ScriptAct::Kind::kSignal, Signal::kOff, kAuto},
              {milliseconds(4), ScriptAct::Kind::kSignal, Signal::kOn, kAuto}};
  const SwitchReceipt receipt = go({"speed", 0, Relation::kLess, 4.5}, milliseconds(20));
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(state_of_auto_, chimera::State::kOff);
  ASSERT_EQ(refused_.size(), 1u);
  EXPECT_EQ(refused_[0].why, Refusal::kSwitch);
  EXPECT_EQ(refused_[0].set, kToHand) << "it names the switch";
}

TEST_P(SafeWhen, IsNotWaitedForWhereItHolds) {
  const SwitchReceipt receipt = go({"speed", 0, Relation::kMore, 4.5}, milliseconds(20));
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_LE(receipt.armed, milliseconds(3));
}

TEST_P(SafeWhen, IsAskedOfElementsAndOfOtherTypes) {
  EXPECT_EQ(go({"axes", 1, Relation::kEqual, 9}, milliseconds(20)).armed.count / 1'000'000, 9);
  const SwitchReceipt receipt = go({"closed", 0, Relation::kEqual, 1}, milliseconds(20));
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_GE(receipt.armed, milliseconds(7));
}

TEST_P(SafeWhen, AConditionThatNeverHoldsAbortsWithTheValue) {
  const SwitchReceipt receipt = go({"speed", 0, Relation::kMore, 100}, seconds(11));
  EXPECT_EQ(receipt.end, SwitchEnd::kAborted);
  EXPECT_EQ(receipt.why, NoSwitch::kNotSafe);
  EXPECT_EQ(receipt.variable, application_->sets[1].safe_when.variable);
  EXPECT_NEAR(receipt.value, 10 - 10002, 2);
  EXPECT_GE(receipt.ended, seconds(10));
  EXPECT_LE(receipt.ended, seconds(10) + milliseconds(5));
}

TEST_P(SafeWhen, AVariableWithoutAProducerIsNotSafe) {
  const SwitchReceipt receipt = go({"third", 0, Relation::kUnequal, 100}, seconds(11));
  EXPECT_EQ(receipt.why, NoSwitch::kNotSafe);
  EXPECT_TRUE(std::isnan(receipt.value));
}

TEST_P(SafeWhen, AnUnwrittenVariableIsNotSafe) {
  int cycles = 0;
  scene.on_of_hand = [&cycles](Cycle) { cycles = scene.cycles; };
  const SwitchReceipt receipt = go({"speed", 0, Relation::kUnequal, 100}, milliseconds(20), {});
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(cycles, 1);
}

TEST_P(SafeWhen, AnInputWithoutAValueHoldsArmingUpUntilItHasOne) {
  const SwitchReceipt receipt = go_to_remote(milliseconds(6), milliseconds(20));
  EXPECT_EQ(receipt.end, SwitchEnd::kDone) << static_cast<int>(receipt.why);
  EXPECT_GE(receipt.armed, milliseconds(6));
  EXPECT_LE(receipt.armed, milliseconds(7));
  EXPECT_EQ(scene.late_at_on, 3);
}

TEST_P(SafeWhen, AnInputThatNeverHasAValueEndsTheSwitchByItsName) {
  const SwitchReceipt receipt = go_to_remote(seconds(50), seconds(11));
  EXPECT_EQ(receipt.end, SwitchEnd::kAborted);
  EXPECT_EQ(receipt.why, NoSwitch::kNoValue);
  EXPECT_EQ(receipt.task, kRemote);
  EXPECT_EQ(receipt.variable.index, Variables(application_->app.spec).find("late"));
  EXPECT_GE(receipt.ended, seconds(10));
  EXPECT_LE(receipt.ended, seconds(10) + milliseconds(5));
  EXPECT_EQ(scene.late_at_on, 0) << "its on was not called";
}

// `on` takes 5 ms, in which the value changes. With one context no task cycles during `on`.
TEST_P(SafeWhen, OnSeveralRtpusAConditionThatFailsBeforeTheProposalAborts) {
  scene.on_of_hand = [](Cycle c) { c.spend(milliseconds(5)); };
  const SwitchReceipt receipt = go({"speed", 0, Relation::kMore, 5.5}, milliseconds(40));
  EXPECT_EQ(receipt.end, GetParam() >= How::kTwoRtpus ? SwitchEnd::kAborted : SwitchEnd::kDone);
}

}  // namespace
}  // namespace chimera::toy::safe_when_test
