// SPDX-License-Identifier: Apache-2.0
// A switch waits until what its configuration asks by `safe_when` holds: on every executor of one context, and over
// several rtpus in virtual time, where the value comes from the other rtpu.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/virtual_rtpus.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

/// What the components of a run do. One run at a time.
struct Scene {
  std::function<double(std::uint64_t)> speed;  // by cycle
  std::function<void(Cycle)> on_of_hand;
  int cycles = 0;  // of plant
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

constexpr TaskId kPlant{0u}, kAuto{1u}, kHand{2u}, kThird{3u};

struct Asked {
  const char* variable;
  std::uint32_t element;
  Relation comparison;
  double limit;
};

/// The four tasks on two rtpus, of which one context may take all; 'hand' may be switched to when `asked` holds.
struct Application {
  explicit Application(const Asked& asked) {
    app.rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    app.add("plant", testing::component<Plant>("plant")).budget = microseconds(20);
    app.add("auto", testing::component<Auto>("auto")).budget = microseconds(20);
    app.add("hand", testing::component<Hand>("hand")).budget = microseconds(20);
    app.add("third", testing::component<Third>("third")).budget = microseconds(20);
    app.tasks[kPlant.index].rtpu = app.tasks[kAuto.index].rtpu = RtpuId{0u};
    app.tasks[kHand.index].rtpu = app.tasks[kThird.index].rtpu = RtpuId{1u};
    app.port(kPlant.index, 2).extent[0].max = 3;
    app.make({kPlant, kAuto}, false);
    const std::size_t variable = Variables(app.spec).find(asked.variable);
    EXPECT_LT(variable, app.spec.variables.size());
    sets[1].safe_when = {VariableId(variable), asked.element, asked.comparison, asked.limit};
    app.spec.sets = sets;
  }
  testing::TestApplication app;
  TaskId automatic[2] = {kPlant, kAuto}, hand[2] = {kPlant, kHand};
  NamedSet sets[2] = {{"automatic", automatic}, {"hand", hand}};
};

ScriptAct to_hand(Nanoseconds at) {
  ScriptAct act;
  act.at = at;
  act.kind = ScriptAct::Kind::kSwitch;
  act.set = 1;
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
    application_ = std::make_unique<Application>(asked);
    testing::TestApplication& app = application_->app;
    const ScriptAct acts[] = {to_hand(at)};
    if (GetParam() >= How::kTwoRtpus) return go_on_two(app, acts, duration);
    auto set = *HeapTaskSet::create(app.spec, app.components);
    Runner runner(*set, static_cast<Kind>(GetParam()), Policy::kEdf, acts);
    EXPECT_TRUE(runner.start());
    EXPECT_EQ(runner.run(duration), RunEnd::kTime);
    runner.shut_down();
    return runner.receipts()[0];
  }
  static SwitchReceipt go_on_two(testing::TestApplication& app, std::span<const ScriptAct> acts, Nanoseconds duration) {
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
    run.shut_down();
    return run.receipts().all()[0];
  }
  std::unique_ptr<Application> application_;
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

TEST_P(SafeWhen, ThatNeverHoldsEndsTheSwitchWithTheValue) {
  const SwitchReceipt receipt = go({"speed", 0, Relation::kMore, 100}, seconds(11));
  EXPECT_EQ(receipt.end, SwitchEnd::kAborted);
  EXPECT_EQ(receipt.why, NoSwitch::kNotSafe);
  EXPECT_EQ(receipt.variable, application_->sets[1].safe_when.variable);
  EXPECT_NEAR(receipt.value, 10 - 10002, 2);
  EXPECT_GE(receipt.ended, seconds(10));
  EXPECT_LE(receipt.ended, seconds(10) + milliseconds(5));
}

TEST_P(SafeWhen, WhatNobodyProducesIsNotSafe) {
  const SwitchReceipt receipt = go({"third", 0, Relation::kUnequal, 100}, seconds(11));
  EXPECT_EQ(receipt.why, NoSwitch::kNotSafe);
  EXPECT_TRUE(std::isnan(receipt.value));
}

TEST_P(SafeWhen, WhatNeverHadAValueIsNotSafe) {
  int cycles = 0;
  scene.on_of_hand = [&cycles](Cycle) { cycles = scene.cycles; };
  const SwitchReceipt receipt = go({"speed", 0, Relation::kUnequal, 100}, milliseconds(20), {});
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(cycles, 1);
}

// `on` takes 5 ms, within which the value becomes another.
TEST_P(SafeWhen, ThatHoldsNoMoreWhenTheInstantWouldBeProposedTakesTheSwitchBack) {
  scene.on_of_hand = [](Cycle c) { c.spend(milliseconds(5)); };
  const SwitchReceipt receipt = go({"speed", 0, Relation::kMore, 5.5}, milliseconds(40));
  EXPECT_EQ(receipt.end, GetParam() >= How::kTwoRtpus ? SwitchEnd::kAborted : SwitchEnd::kDone);
}

}  // namespace
}  // namespace chimera::toy
