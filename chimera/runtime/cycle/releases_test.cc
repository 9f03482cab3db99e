// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/cycle/releases.h"

#include <gtest/gtest.h>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera {
namespace {

struct FailingSender {  // signals the other task, or fails for ever, by its flags
  Out<double> x{"x", "1", initial = 0.0};
  Outcome cycle(Cycle c) {
    if (std::exchange(turns_off, false)) c.signal(Signal::kOff, "slow");
    return fails ? fault("as told") : ok();
  }
  bool error(Cycle) { return false; }
  static inline bool turns_off = false, fails = false;
};

struct SignalledReader {
  In<double> x{"x", "1"};
  void cycle(Cycle) {}
};

constexpr TaskId kFast{0u}, kSlow{1u};
constexpr Nanoseconds kEnd = milliseconds(100);

/// A task of 1 ms and one of 3 ms that reads from it.
struct ReleasesTest : ::testing::Test {
  ReleasesTest() {
    FailingSender::turns_off = FailingSender::fails = false;
    app.add("fast", testing::component<FailingSender>("sender"), milliseconds(1));
    app.add("slow", testing::component<SignalledReader>("reader"), milliseconds(3));
  }
  /// The grid of releases begins at 10 ms.
  void begin() {
    set = *HeapTaskSet::create(app.make(), app.components);
    releases.emplace(*set, clock, options);
    ASSERT_TRUE(set->life().start({}));
    releases->begin(milliseconds(10));
  }
  bool run_next(Nanoseconds now) {
    const Job job = releases->queue().pop();
    if (!releases->may_start(job, now)) return false;
    CycleTime time;
    const BodyEnd body = releases->jobs().open_and_begin(job, time, false);
    releases->end_job(job, time, body, now, now + microseconds(10), microseconds(10));
    return true;
  }
  /// Everything that is due is looked at, and all jobs that are ready run.
  void run_all(Nanoseconds now) {
    if (releases->edge_is_due(now)) releases->take_edge(now);
    releases->release_due(now);
    while (!releases->queue().is_empty()) (void)run_next(now);
    releases->rest(kEnd);
  }
  Task& task(TaskId id) { return set->tasks()[id.index]; }

  testing::TestApplication app;
  ModelledClock clock;
  RunOptions options;
  std::unique_ptr<HeapTaskSet> set;
  std::optional<Releases> releases;
};

TEST_F(ReleasesTest, ReleasesTasksOnTheGridThatBeginsAtTheOrigin) {
  begin();
  EXPECT_EQ(releases->origin(), milliseconds(10));
  EXPECT_EQ(releases->queue().next_release(), milliseconds(10));
  releases->release_due(milliseconds(10) - Nanoseconds{1});
  EXPECT_TRUE(releases->queue().is_empty());
  releases->release_due(milliseconds(10));
  const Job job = releases->queue().pop();
  EXPECT_EQ(job.task, kFast) << "its deadline is the earlier one";
  EXPECT_EQ(job.release, milliseconds(10));
  EXPECT_EQ(job.deadline, milliseconds(11));
  EXPECT_EQ(releases->queue().pop().task, kSlow);
  EXPECT_EQ(releases->queue().next_release(), milliseconds(11));
}

TEST_F(ReleasesTest, LooksUpOnlyWhenSomethingIsDue) {
  begin();
  run_all(milliseconds(10));
  EXPECT_FALSE(releases->must_look(milliseconds(11) - Nanoseconds{1}));
  EXPECT_TRUE(releases->must_look(milliseconds(11))) << "a release";
  releases->rest(microseconds(10'500));
  EXPECT_TRUE(releases->must_look(microseconds(10'500))) << "the end of the run";
  releases->rest(kEnd);
  releases->look_again();
  EXPECT_TRUE(releases->must_look(milliseconds(10)));
}

TEST_F(ReleasesTest, LooksUpForAnActOfTheScript) {
  const ScriptAct acts[] = {{microseconds(200), ScriptAct::Kind::kRaiseFlag, Signal::kOn, TaskId()}};
  options.script = Script(acts);
  begin();
  run_all(milliseconds(10));
  EXPECT_EQ(releases->next_edge(), microseconds(10'200));
  EXPECT_FALSE(releases->must_look(microseconds(10'199)));
  EXPECT_FALSE(releases->edge_is_due(microseconds(10'199)));
  EXPECT_TRUE(releases->must_look(microseconds(10'200)));
  EXPECT_TRUE(releases->edge_is_due(microseconds(10'200)));
  releases->take_edge(microseconds(10'200));
  EXPECT_TRUE(releases->is_illegal());
  EXPECT_EQ(releases->next_edge(), kNever);
}

TEST_F(ReleasesTest, LooksUpAtOnceForASignalThatAJobSent) {
  begin();
  FailingSender::turns_off = true;
  run_all(milliseconds(10));
  EXPECT_TRUE(releases->must_look(milliseconds(10)));
  EXPECT_TRUE(releases->edge_is_due(milliseconds(10)));
  releases->take_edge(milliseconds(10));
  EXPECT_EQ(task(kSlow).state, State::kOff);
  EXPECT_FALSE(releases->members().is_on(kSlow));
}

TEST_F(ReleasesTest, LooksUpWheneverAStopIsAskedFor) {
  std::atomic<bool> stop{false};  // pairs with nothing: one thread
  options.stop = &stop;
  begin();
  run_all(milliseconds(10));
  EXPECT_FALSE(releases->must_look(milliseconds(10)));
  stop = true;
  EXPECT_TRUE(releases->must_look(milliseconds(10)));
  EXPECT_TRUE(releases->stop_requested());
}

TEST_F(ReleasesTest, AReleaseThatFindsTheJobBeforeItUnstartedIsDroppedAndMissed) {
  begin();
  releases->release_due(milliseconds(10));
  releases->release_due(milliseconds(12));
  EXPECT_EQ(task(kFast).profile.dropped, 2u);
  EXPECT_EQ(task(kFast).profile.missed, 2u);
  EXPECT_EQ(task(kSlow).profile.dropped, 0u);
}

TEST_F(ReleasesTest, ATaskThatNeverGetsToRunEndsWhenItsPatienceDoes) {
  app.tasks[0].max_consecutive = 2;
  begin();
  releases->release_due(milliseconds(10));
  releases->release_due(milliseconds(11));
  EXPECT_EQ(task(kFast).state, State::kOn);
  releases->release_due(milliseconds(12));
  EXPECT_EQ(task(kFast).state, State::kError);
  EXPECT_FALSE(releases->members().is_on(kFast));
  EXPECT_TRUE(releases->is_illegal()) << "the slow task has lost its producer";
  EXPECT_TRUE(releases->must_look(milliseconds(12)));
}

TEST_F(ReleasesTest, AJobThatIsRefusedIsSettledAtOnce) {
  app.tasks[0].min_time = microseconds(400);
  app.tasks[0].on_miss = OnMiss::kError;
  begin();
  releases->release_due(milliseconds(10));
  EXPECT_FALSE(run_next(microseconds(10'700)));
  EXPECT_EQ(task(kFast).profile.min_refused, 1u);
  EXPECT_EQ(task(kFast).state, State::kError) << "its method error does not recover";
  EXPECT_FALSE(releases->members().is_on(kFast));
}

TEST_F(ReleasesTest, AReactionThatRefusesLateStartsNeedsTheDeadlineItself) {
  app.tasks[0].on_miss = OnMiss::kAbort;
  begin();
  releases->release_due(milliseconds(10));
  const Job job = releases->queue().pop();
  EXPECT_TRUE(releases->may_start(job, job.deadline - Nanoseconds{1}));
  EXPECT_FALSE(releases->may_start(job, job.deadline));
}

TEST_F(ReleasesTest, ReactionsOfAJobAreSettledAtItsEnd) {
  begin();
  FailingSender::fails = true;
  releases->release_due(milliseconds(10));
  releases->rest(kEnd);
  EXPECT_TRUE(run_next(milliseconds(10)));
  EXPECT_EQ(task(kFast).state, State::kError);
  EXPECT_FALSE(releases->members().is_on(kFast));
  EXPECT_TRUE(releases->must_look(milliseconds(10)));
}

TEST_F(ReleasesTest, NothingIsLeftWhenAllTasksAreOffAndNoActIsToCome) {
  const ScriptAct acts[] = {{milliseconds(5), ScriptAct::Kind::kSignal, Signal::kOff, kSlow},
                            {milliseconds(7), ScriptAct::Kind::kSignal, Signal::kOff, kFast},
                            {milliseconds(9), ScriptAct::Kind::kLowerFlag, Signal::kOn, TaskId()}};
  options.script = Script(acts);
  begin();
  EXPECT_TRUE(releases->anything_left());
  releases->take_edge(milliseconds(17));
  EXPECT_FALSE(releases->members().is_any_on());
  EXPECT_TRUE(releases->anything_left()) << "an act is to come";
  releases->take_edge(milliseconds(19));
  EXPECT_FALSE(releases->anything_left());
}

}  // namespace
}  // namespace chimera
