// SPDX-License-Identifier: Apache-2.0
// Reports about a job that misses its deadline, while it still runs. The tests need no real-time levels, so they run
// under the thread sanitizer too. miss_cause_test.cc and edge_access_test.cc prove the blame on a stepped clock.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

#include "chimera/base/testing/await.h"
#include "chimera/platform/clock.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/listener.h"
#include "tests/conformance/toy.h"

namespace chimera::toy {
namespace {

/// "late" stays in its second cycle until the test sets `has_seen`; "beside" reads the flag.
class Late : public ::testing::Test {
 protected:
  Late() {
    spec = &app.add("late", milliseconds(100));
    app.add("beside", milliseconds(10));
    app.toy("late").during = [this](const chimera_call&) {
      if (++cycles_ != 2) return CHIMERA_OK;
      stays = true;
      const Nanoseconds limit = clock_.now() + kHangLimit;
      while (!has_seen && clock_.now() < limit) wait();
      stays = false;
      return CHIMERA_OK;
    };
    app.toy("beside").during = [this](const chimera_call& call) {
      if (call.illegal == 0 || !stays) return CHIMERA_OK;
      has_seen = has_flag = ends = true;
      Doorbell(bell).ring();
      return CHIMERA_OK;
    };
  }
  RunEnd run(Nanoseconds time = milliseconds(300)) {
    ProcessorPlace place;
    place.bell = &bell;
    RunOptions options;
    options.guest = &listener;
    options.stop = &ends;
    executor = std::make_unique<PreemptiveExecutor>(app.build_preemptive(), options, place);
    EXPECT_TRUE(executor->start());
    return executor->run(time);
  }
  const Profile& profile() { return app.task("late").profile; }
  /// True if only the second job of "late" missed, with the releases that it dropped. False: the host delayed a job.
  bool is_the_only_one_late() { return profile().missed == profile().dropped + 1; }

  Application app;
  TaskSpec* spec;
  std::atomic<std::uint32_t> bell{0};
  Listener listener{bell};
  std::unique_ptr<PreemptiveExecutor> executor;
  std::atomic<bool> stays{false}, has_seen{false}, has_flag{false}, ends{false};
  std::function<void()> wait = [this] { (void)clock_.wait_until(clock_.now() + milliseconds(1)); };

 private:
  LinuxClock clock_;
  int cycles_ = 0;  // of "late"
};

// The listener hears of a miss within 100 ms; this job ends later. The releases that it drops are no further misses.
TEST_F(Late, ALongMissIsReportedOnce) {
  std::atomic<int> told_under_way{0};
  listener.on_miss = [&](TaskId task, const MissCause::Verdict&) {
    if (task == app.id("late") && stays) ++told_under_way;
  };
  wait = [&] {
    if (told_under_way == 0) return;
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(350));
    has_seen = true;
  };
  run(milliseconds(850));
  EXPECT_EQ(told_under_way, 1);
  EXPECT_GE(profile().dropped, 2u);
  EXPECT_TRUE(listener.of(app.id("late")).size() == 1 || !is_the_only_one_late());
}

TEST_F(Late, RaisesTheFlagWhileItIsUnderWay) {
  spec->on_miss = OnMiss::kFlag;
  run(kHangLimit);  // until it is seen
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
  run(milliseconds(600));
  EXPECT_GE(listener.of(app.id("late")).size(), 1u) << "a tolerated miss is reported too";
  EXPECT_FALSE(has_flag && is_the_only_one_late());
  EXPECT_GE(profile().tolerated, 1u);
}

TEST_F(Late, OverItsBudgetRaisesTheFlagWhileItIsUnderWay) {
  spec->period = spec->deadline = seconds(30);
  spec->budget = milliseconds(100);  // ten times that, and it is given up
  spec->on_overrun = OnMiss::kFlag;
  wait = [] {};  // computes
  app.toy("late").during = [during = app.toy("late").during, n = 0](const chimera_call& call) mutable {
    while (++n < 2) (void)during(call);  // its first job is the one
    return during(call);
  };
  run(kHangLimit);
  EXPECT_TRUE(has_flag);
  EXPECT_EQ(profile().overrun, 1u);
  EXPECT_EQ(profile().missed, 0u);
}

TEST_F(Late, StopsTheRunWhileItIsUnderWay) {
  spec->period = seconds(1);  // no third job in the run that goes on
  spec->deadline = milliseconds(400);
  spec->on_miss = OnMiss::kStop;
  spec->budget = microseconds(1);
  spec->on_overrun = OnMiss::kDemote;
  EXPECT_EQ(run(kHangLimit), RunEnd::kTaskStopped);
  EXPECT_TRUE(stays) << "it is not waited for";
  EXPECT_EQ(executor->releases().settlement().stopped_by(), app.id("late"));
  std::uint64_t before = 0;
  executor->at_edge([&] { before = executor->counts().supervised; });
  (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(300));
  executor->at_edge([&] {
    EXPECT_LT(executor->counts().supervised - before, 100u) << "without releases there is no reason to poll";
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
  std::atomic<std::uint64_t> begun{0};
  std::uint64_t came_in = 0;  // the job in which the edge came first
  app.toy("late").during = [&](const chimera_call&) {
    if (++begun == 5) {
      wants_off = true;
      Doorbell(bell).ring();
    }
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(25));
    return CHIMERA_OK;
  };
  listener.on_take = [&](BoundarySignals& signals, Nanoseconds now) {
    const TaskId late = app.id("late");
    if (!wants_off) return;
    if (came_in == 0) came_in = begun;
    if (!signals.may_touch(late)) return;
    wants_off = false;
    EXPECT_TRUE(signals.signal({&late, 1}, Signal::kOff, now).is_accepted);
  };
  run();
  while (app.task("late").state != chimera::State::kOff && LinuxClock().now() < executor->origin() + kHangLimit)
    executor->run(LinuxClock().now() - executor->origin() + milliseconds(20));
  EXPECT_EQ(app.task("late").state, chimera::State::kOff);
  EXPECT_GE(came_in, 5u);
  EXPECT_GE(profile().cycles, came_in);
  EXPECT_LE(profile().cycles, came_in + 1) << "one may have begun that had not counted itself yet";
}

TEST_F(Late, AJobThatEndsInTimeIsNoMiss) {
  has_seen = true;
  run();
  EXPECT_EQ(listener.of(app.id("late")).empty(), profile().missed == 0);
}

}  // namespace
}  // namespace chimera::toy
