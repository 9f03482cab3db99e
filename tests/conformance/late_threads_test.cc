// SPDX-License-Identifier: Apache-2.0
// A job that is not over at its deadline: what the others learn of it while it is still under way. Without real-time
// levels, so also under the thread sanitizer; how soon they learn it is judged by late_realtime_test.cc.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

#include "chimera/platform/linux_clock.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/listener.h"
#include "tests/conformance/toy.h"

namespace chimera::toy {
namespace {

/// "late" stays in its second cycle until the test has seen what it waits for; "beside" looks at the flag.
class Late : public ::testing::Test {
 protected:
  Late() {
    spec = &app.add("late", milliseconds(100));
    app.add("beside", milliseconds(10));
    app.toy("late").during = [this](const chimera_call&) {
      if (++cycles_ != 2) return CHIMERA_OK;
      stays = true;
      const Nanoseconds patience = clock_.now() + seconds(20);
      while (!has_seen && clock_.now() < patience) wait();
      stays = false;
      return CHIMERA_OK;
    };
    app.toy("beside").during = [this](const chimera_call& call) {
      if (call.illegal != 0 && stays) has_seen = has_flag = true;
      return CHIMERA_OK;
    };
  }
  RunEnd run(std::int64_t ms = 300) {
    ProcessorPlace place;
    place.bell = &bell;
    RunOptions options;
    options.guest = &listener;
    executor = std::make_unique<PreemptiveExecutor>(app.build_preemptive(), options, place);
    EXPECT_TRUE(executor->start());
    return executor->run(milliseconds(ms));
  }
  const Profile& profile() { return app.task("late").profile; }

  Application app;
  TaskSpec* spec;
  std::atomic<std::uint32_t> bell{0};
  Listener listener{bell};
  std::unique_ptr<PreemptiveExecutor> executor;
  std::atomic<bool> stays{false}, has_seen{false}, has_flag{false};
  std::function<void()> wait = [this] { (void)clock_.wait_until(clock_.now() + milliseconds(1)); };

 private:
  LinuxClock clock_;
  int cycles_ = 0;  // of "late"
};

// One miss of a task is told in 100 ms at most; this job ends later than that, and before its next release.
TEST_F(Late, IsToldOnceAndBlamedForWaiting) {
  spec->period = milliseconds(600);
  spec->deadline = milliseconds(100);
  std::vector<bool> was_under_way;
  listener.on_miss = [&](TaskId task, const MissCause::Verdict&) {
    if (task == app.id("late")) was_under_way.push_back(stays);
  };
  wait = [this] {
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(300));
    has_seen = true;
  };
  run(1'150);
  EXPECT_EQ(was_under_way, std::vector<bool>{true});
  ASSERT_EQ(listener.of(app.id("late")).size(), 1u);
  EXPECT_EQ(listener.of(app.id("late"))[0].culprit, app.id("late"));
  EXPECT_TRUE(listener.of(app.id("late"))[0].is_blocked);
  EXPECT_EQ(profile().missed, 1u);
}

// Nor are the releases that it was in the way of told as misses of their own.
TEST_F(Late, IsToldOnceAlsoWhenItDropsReleases) {
  wait = [this] {
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(450));
    has_seen = true;
  };
  run(650);
  EXPECT_GE(profile().dropped, 2u);
  EXPECT_EQ(listener.of(app.id("late")).size(), 1u);
}

TEST_F(Late, RaisesTheFlagWhileItIsUnderWay) {
  spec->on_miss = OnMiss::kFlag;
  run();
  EXPECT_TRUE(has_flag);
}

TEST_F(Late, DoesNotRaiseTheFlagWhenTheMissIsTolerated) {
  spec->on_miss = OnMiss::kFlag;
  spec->tolerated_misses = 1;
  spec->tolerated_of = 2;
  wait = [this] {
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(200));
    has_seen = true;
  };
  run();
  EXPECT_GE(listener.of(app.id("late")).size(), 1u) << "it is told all the same";
  EXPECT_FALSE(has_flag);
  EXPECT_GE(profile().tolerated, 1u);
}

TEST_F(Late, OverItsBudgetRaisesTheFlagWhileItIsUnderWay) {
  spec->period = spec->deadline = seconds(30);
  spec->budget = milliseconds(2);
  spec->on_overrun = OnMiss::kFlag;
  wait = [] {};  // computes
  app.toy("late").during = [during = app.toy("late").during, n = 0](const chimera_call& call) mutable {
    while (++n < 2) (void)during(call);  // its first job is the one
    return during(call);
  };
  run();
  EXPECT_TRUE(has_flag);
  EXPECT_EQ(profile().overrun, 1u);
  EXPECT_EQ(profile().missed, 0u);
}

TEST_F(Late, StopsTheRunWhileItIsUnderWay) {
  spec->on_miss = OnMiss::kStop;
  spec->budget = microseconds(1);
  spec->on_overrun = OnMiss::kDemote;
  EXPECT_EQ(run(30'000), RunEnd::kTaskStopped);
  EXPECT_TRUE(stays) << "it is not waited for";
  EXPECT_EQ(executor->releases().settlement().stopped_by(), app.id("late"));
  (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(300));
  executor->at_edge([this] {
    EXPECT_LT(executor->counts().supervised, 300u) << "nobody is released now: no reason to look again and again";
  });
  executor->at_edge([this] { executor->releases().settlement().forget_stop(); });
  has_seen = true;
  EXPECT_EQ(executor->run(LinuxClock().now() - executor->origin() + milliseconds(50)), RunEnd::kTime)
      << "its end does not stop once more";
  EXPECT_FALSE(stays);
  EXPECT_GE(profile().missed, 1u);
}

// Each job is late, and the next is due when it ends: an edge that came for the task gets its turn in between.
TEST_F(Late, TakesSignalsAlsoWhenItAlwaysIs) {
  spec->period = spec->deadline = milliseconds(10);
  std::atomic<bool> wants_off{false};
  app.toy("late").during = [&, n = 0](const chimera_call&) mutable {
    if (++n == 5) {
      wants_off = true;
      Doorbell(bell).ring();
    }
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(25));
    return CHIMERA_OK;
  };
  listener.on_take = [&](BoundarySignals& signals, Nanoseconds now) {
    const TaskId late = app.id("late");
    if (!wants_off || !signals.may_touch(late)) return;
    wants_off = false;
    EXPECT_TRUE(signals.signal({&late, 1}, Signal::kOff, now).is_accepted);
  };
  run(1'000);
  EXPECT_EQ(app.task("late").state, chimera::State::kOff);
  EXPECT_EQ(profile().cycles, 5u);
}

TEST_F(Late, IsNobodyWhoEndsInTime) {
  has_seen = true;
  run();
  EXPECT_EQ(listener.of(app.id("late")).empty(), profile().missed == 0);
}

}  // namespace
}  // namespace chimera::toy
