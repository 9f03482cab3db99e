// SPDX-License-Identifier: Apache-2.0
// Standbys on other rtpus of virtual time: they take over from a task that fails and from an rtpu that dies.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "chimera/runtime/testing/virtual_scene.h"

namespace chimera::virtual_standbys_test {
namespace {

using testing::VirtualScene;

/// Orders to the components of a run, and their observations. One run at a time.
struct Scene {
  std::vector<double> u;
  std::int64_t fails_at = -1, hangs_at = -1;  // of the primary
  bool on_of_spare_fails = false;
  int ons_of_spare = 0;
  std::vector<std::int64_t> illegal;  // cycles that saw the flag up
};
Scene scene;

struct Primary {
  Out<double> u{"u", "1", initial = 0.0};
  Outcome cycle(Cycle c) {
    *u = static_cast<double>(c.count()) + 1;
    if (c.now().count == scene.hangs_at) c.spend(seconds(1));
    return c.now().count == scene.fails_at ? fault("no current") : ok();
  }
};

struct Standby {
  In<double> x{"x", "1"};  // from the rtpu of the primary
  Out<double> u{"u", "1", initial = 0.0};
  Outcome on(Cycle) {
    ++scene.ons_of_spare;
    return scene.on_of_spare_fails ? fault("no voltage") : ok();
  }
  void cycle(Cycle) { *u = *u + 100; }
};

struct Source {
  Out<double> x{"x", "1", initial = 0.0};
  void cycle(Cycle) { *x = 1; }
};

struct User {
  In<double> u{"u", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  void cycle(Cycle c) {
    *seen = *u;
    scene.u.push_back(*u);
    if (c.illegal()) scene.illegal.push_back(c.now().count);
  }
};

constexpr TaskId kPrimary{0u}, kUser{1u}, kSpare{2u}, kLast{3u}, kSource{4u};

ScriptAct death_at(Nanoseconds at, std::uint32_t rtpu) {
  return testing::act_at(at, ScriptAct::Kind::kDie, rtpu);
}

/// The primary, what reads it, and its two standbys, each on an rtpu of its own.
struct VirtualStandbysTest : ::testing::TestWithParam<bool> {
  void go(Nanoseconds duration, std::vector<ScriptAct> acts = {}) {
    rtpus.reset();
    auto app = std::make_unique<testing::TestApplication>();
    app->rtpus = {{"a", 0, Policy::kEdf}, {"b", 1, Policy::kEdf}, {"c", 2, Policy::kEdf}, {"d", 3, Policy::kEdf}};
    app->add("primary", testing::component<Primary>("primary")).rtpu = RtpuId(0u);
    app->add("user", testing::component<User>("user")).rtpu = RtpuId(1u);
    app->add("spare", testing::component<Standby>("standby")).rtpu = RtpuId(2u);
    app->add("last", testing::component<Standby>("standby")).rtpu = RtpuId(3u);
    app->add("source", testing::component<Source>("source")).rtpu = RtpuId(source_rtpu);
    app->make({kSource, kPrimary, kUser}, false);
    app->spec.standbys = pairs;
    rtpus = std::make_unique<VirtualScene>(std::move(app), std::move(acts), GetParam());
    rtpus->run(duration);
  }
  State state(TaskId task) const { return rtpus->state(task); }
  void SetUp() override { scene = {}; }
  void TearDown() override { rtpus.reset(); }

  std::uint32_t source_rtpu = 1;
  std::vector<StandbySpec> pairs{{kPrimary, kSpare}, {kPrimary, kLast}};
  std::unique_ptr<VirtualScene> rtpus;
};

INSTANTIATE_TEST_SUITE_P(All, VirtualStandbysTest, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "Preemptive" : "Executive"; });

TEST_P(VirtualStandbysTest, TakeOverFromATaskThatFailsInAnotherRtpu) {
  scene.fails_at = milliseconds(4).count;
  go(milliseconds(8));
  EXPECT_EQ(state(kPrimary), State::kError);
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_EQ(state(kLast), State::kOff);
  EXPECT_EQ(scene.illegal, std::vector<std::int64_t>{});
  // It goes ON at the instant of the fault and is released at that instant too: it loses no cycle.
  EXPECT_EQ(scene.u, (std::vector<double>{0, 1, 2, 3, 4, 104, 204, 304}));
  rtpus->rtpus().shut_down();
  ASSERT_EQ(rtpus->receipts().size(), 1u);
  EXPECT_EQ(rtpus->receipts()[0].by, kSpare);
  EXPECT_FALSE(rtpus->receipts()[0].was_death);
}

TEST_P(VirtualStandbysTest, TakeOverFromARtpuThatDies) {
  go(milliseconds(8), {death_at(microseconds(3500), 0)});
  EXPECT_EQ(state(kPrimary), State::kError);
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_EQ(scene.illegal, std::vector<std::int64_t>{});
  EXPECT_EQ(scene.u, (std::vector<double>{0, 1, 2, 3, 4, 104, 204, 304}));
  ASSERT_EQ(rtpus->receipts().size(), 1u);
  const SwitchReceipt& receipt = rtpus->receipts()[0];
  EXPECT_EQ(receipt.by, kSpare);
  EXPECT_EQ(receipt.in_place_of, kPrimary);
  EXPECT_TRUE(receipt.was_death);
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(receipt.at - rtpus->rtpus().origin(), microseconds(3500)) << "as soon as it is seen";
  ASSERT_EQ(receipt.variables.size(), 1u);
  EXPECT_EQ(receipt.variables[0].step_of_on.size, 0);
  EXPECT_EQ(receipt.variables[0].step_of_cycle.size, 100);
}

TEST_P(VirtualStandbysTest, TheNextOneTakesOverWhenTheFirstIsDeadOrFails) {
  go(milliseconds(10), {death_at(microseconds(2500), 2), death_at(microseconds(3500), 0)});
  EXPECT_EQ(state(kLast), State::kOn);
  EXPECT_EQ(scene.illegal, std::vector<std::int64_t>{});
  go(milliseconds(10), {death_at(microseconds(3500), 0), death_at(microseconds(5500), 2)});
  EXPECT_EQ(state(kLast), State::kOn);
  EXPECT_EQ(scene.illegal, std::vector<std::int64_t>{});
  scene.on_of_spare_fails = true;
  go(milliseconds(10), {death_at(microseconds(3500), 0)});
  EXPECT_EQ(state(kSpare), State::kError);
  EXPECT_EQ(state(kLast), State::kError);
  EXPECT_EQ(scene.illegal.front(), milliseconds(4).count) << "no standby is left: at once";
}

TEST_P(VirtualStandbysTest, WithoutAFitOneTheFlagIsUpAtOnce) {
  pairs = {{kPrimary, kSpare}};
  go(milliseconds(8), {death_at(microseconds(3500), 0), death_at(microseconds(3500), 2)});
  EXPECT_EQ(scene.illegal.front(), milliseconds(4).count) << "no standby that is fit is left";
}

TEST_P(VirtualStandbysTest, TakeOverThoughTheirInputFailedWithThePrimary) {
  source_rtpu = 0;
  go(milliseconds(8), {death_at(microseconds(3500), 0)});
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_EQ(scene.u, (std::vector<double>{0, 1, 2, 3, 4, 104, 204, 304}));
  EXPECT_EQ(scene.illegal.front(), milliseconds(4).count) << "no task produces x";
}

TEST_P(VirtualStandbysTest, APrimaryThatPublishesNothingForTooLongIsKilledAndThenReplaced) {
  pairs[0].stale_after = milliseconds(3);
  scene.hangs_at = milliseconds(4).count;
  go(milliseconds(11));
  EXPECT_EQ(state(kPrimary), State::kError);
  ASSERT_NE(rtpus->peers().died(RtpuId(0u)), kNever);
  EXPECT_EQ(rtpus->peers().died(RtpuId(0u)) - rtpus->rtpus().origin(), milliseconds(7));
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_EQ(scene.illegal, std::vector<std::int64_t>{});
  // The last publication is from the cycle of 3 ms: it is older than 3 ms at the check of 7 ms, which kills the rtpu.
  EXPECT_EQ(scene.u, (std::vector<double>{0, 1, 2, 3, 4, 4, 4, 4, 104, 204, 304}));
}

TEST_P(VirtualStandbysTest, LeavesASilentPrimaryAloneWhenItsStandbyIsDead) {
  pairs = {{kPrimary, kSpare, milliseconds(3), false}};
  scene.hangs_at = milliseconds(4).count;
  go(milliseconds(11), {death_at(microseconds(500), 2)});
  EXPECT_EQ(state(kPrimary), State::kOn);
  EXPECT_EQ(rtpus->peers().died(RtpuId(0u)), kNever);
}

TEST_P(VirtualStandbysTest, AHotOneIsReadFromTheDeathOnWhereItIs) {
  pairs[0].hot = true;
  go(milliseconds(8), {death_at(microseconds(3500), 0)});
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_EQ(scene.ons_of_spare, 1);
  EXPECT_EQ(scene.illegal, std::vector<std::int64_t>{});
  // It began beside the primary at 0 ms, after u was 0, and adds 100 in each cycle.
  EXPECT_EQ(scene.u, (std::vector<double>{0, 1, 2, 3, 400, 500, 600, 700}));
}

TEST_P(VirtualStandbysTest, ARunRepeatsExactly) {
  scene.fails_at = milliseconds(4).count;
  go(milliseconds(8), {death_at(milliseconds(6), 2)});
  const std::vector<double> first = scene.u;
  scene.u.clear();
  go(milliseconds(8), {death_at(milliseconds(6), 2)});
  EXPECT_EQ(scene.u, first);
  EXPECT_EQ(state(kLast), State::kOn);
}

}  // namespace
}  // namespace chimera::virtual_standbys_test
