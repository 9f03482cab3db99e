// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/life/slow_methods.h"

#include <gtest/gtest.h>

#include <string>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/task_word.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera::slow_methods_test {
namespace {

std::atomic<std::uint32_t> serving{0}, at_edge{0};
std::string story;  // of methods, with what the two words say while each runs

std::string seen(const char* method) {
  const bool is_served = TaskWord::found(serving).has_method(), is_at_edge = TaskWord::found(at_edge).has_method();
  return std::string(method) + (is_served ? " served; " : is_at_edge ? " at edge; " : " unseen; ");
}

struct Slow {
  Out<double> x{"x", "1", initial = 0.0};
  Outcome init(Cycle c) {
    story += seen("init");
    c.spend(milliseconds(7));
    return fails ? fault("as told") : ok();
  }
  void on(Cycle) { story += seen("on"); }
  void off(Cycle) { story += seen("off"); }
  void kill(Cycle) { story += seen("kill"); }
  void cycle(Cycle) {}
  static inline bool fails = false;
};

/// A service thread that runs when the test says so.
struct HandService final : Service {
  void ask(TaskId task) noexcept override { asked.push_back(task); }
  bool take_served(TaskId&) noexcept override { return false; }
  std::vector<TaskId> asked;
};

constexpr TaskId kSlow{0u};

struct SlowMethodsTest : ::testing::Test {
  SlowMethodsTest() {
    Slow::fails = false;
    story.clear();
    app.add("slow", testing::component<Slow>("slow"));
    app.make();
    ContextPlace place;
    place.service = &service;
    place.serving = &serving;
    place.at_edge = &at_edge;
    set = *HeapTaskSet::create(app.spec, app.components, place);
    set->methods().run_by({&edge_clock});
  }
  Task& task() { return set->tasks()[0]; }
  SignalReport serve() {
    EXPECT_EQ(service.asked.size(), 1u);
    service.asked.clear();
    set->slow().run(kSlow, service_clock);
    return set->life().finish_slow(kSlow, milliseconds(1));
  }
  /// Serves until nothing more is asked for.
  SignalReport signal(Signal signal) {
    SignalReport report = set->life().signal(kSlow, signal, {});
    while (report.is_deferred) report = serve();
    return report;
  }

  testing::TestApplication app;
  HandService service;
  ModelledClock edge_clock, service_clock;
  std::unique_ptr<HeapTaskSet> set;
};

TEST_F(SlowMethodsTest, ConstructionAndInitAreRunByTheServiceThreadOneAfterTheOther) {
  const SignalReport asked = set->life().signal(kSlow, Signal::kSpawn, {});
  EXPECT_TRUE(asked.is_deferred);
  EXPECT_TRUE(task().in_service);
  EXPECT_EQ(story, "");
  const SignalReport constructed = serve();
  EXPECT_TRUE(constructed.is_deferred) << "init is to come";
  EXPECT_EQ(story, "");
  const SignalReport done = serve();
  EXPECT_FALSE(done.is_deferred);
  EXPECT_EQ(done.after, State::kOff);
  EXPECT_FALSE(task().in_service);
  EXPECT_EQ(story, "init served; ");
}

TEST_F(SlowMethodsTest, OnlyInitAndKillLeaveTheEdge) {
  (void)signal(Signal::kSpawn);
  (void)signal(Signal::kOn);
  (void)signal(Signal::kKill);
  EXPECT_EQ(story, "init served; on at edge; off at edge; kill served; ");
  EXPECT_EQ(task().state, State::kNotCreated);
  EXPECT_EQ(task().instance, nullptr) << "destroyed where kill ran";
}

TEST_F(SlowMethodsTest, MeasuresAMethodOnTheClockOfTheServiceThread) {
  (void)signal(Signal::kSpawn);
  EXPECT_EQ(task().profile.execution[CHIMERA_INIT].max, milliseconds(7));
  EXPECT_EQ(edge_clock.spent(), Nanoseconds{});
}

TEST_F(SlowMethodsTest, AFailedInitIsFollowedByKillAndTheTaskIsNotThere) {
  Slow::fails = true;
  const SignalReport report = signal(Signal::kSpawn);
  EXPECT_EQ(report.after, State::kNotCreated);
  EXPECT_EQ(story, "init served; kill served; ");
  EXPECT_STREQ(task().faults.last.text, "as told");
}

TEST_F(SlowMethodsTest, ATaskThatIsBeingKilledIsOnNoMore) {
  (void)signal(Signal::kSpawn);
  (void)signal(Signal::kOn);
  (void)set->life().signal(kSlow, Signal::kKill, {});
  EXPECT_EQ(task().state, State::kOff);
  EXPECT_TRUE(task().in_service);
}

}  // namespace
}  // namespace chimera::slow_methods_test
