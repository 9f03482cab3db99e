// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/virtual/sporadic_tasks.h"

#include <gtest/gtest.h>

#include <memory>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera {
namespace {

struct Quiet {
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle) {}
};

constexpr TaskId kPeriodic{0u}, kServed{1u};

/// A periodic task, and one behind a server of 2 ms every 10 ms; both are ON, from 0 on.
class SporadicTasksTest : public ::testing::Test {
 protected:
  SporadicTasksTest() {
    for (const char* name : {"periodic", "served"}) {
      app.add(name, testing::component<Quiet>("quiet"), milliseconds(10));
      app.link(app.tasks.size() - 1, 0, name);
    }
    app.tasks[kServed.index].server = ServerSpec{ServerKind::kSporadic, milliseconds(2), milliseconds(10)};
    auto made = HeapTaskSet::create(app.make(), app.components, ContextPlace{});
    set = *std::move(made);
    RunOptions options;
    options.preemptive = true;
    releases = std::make_unique<Releases>(*set, clock, options);
    processor = std::make_unique<VirtualProcessor>(releases->tap(), 2);
    sporadic = std::make_unique<SporadicTasks>(*releases, set->spec().tasks, *processor);
    (void)set->life().start({});
    releases->begin({});
    sporadic->open();
  }
  void events(std::uint32_t waiting) { releases->task(kServed).events = waiting; }
  /// The most urgent ready job gets the processor.
  Job dispatch(Nanoseconds now) {
    const Job job = releases->queue().pop();
    processor->of(job.task).job = job;
    processor->of(job.task).has_begun = true;
    processor->give(job.task, now);
    return job;
  }
  void use(Nanoseconds until) { sporadic->charge(processor->running(), processor->use(until)); }
  bool is_any_ready() { return !releases->queue().is_empty(); }

  testing::TestApplication app;
  ModelledClock clock;
  std::unique_ptr<HeapTaskSet> set;
  std::unique_ptr<Releases> releases;
  std::unique_ptr<VirtualProcessor> processor;
  std::unique_ptr<SporadicTasks> sporadic;
};

TEST_F(SporadicTasksTest, AnEventReleasesAJobThatIsAsUrgentAsTheServer) {
  EXPECT_FALSE(sporadic->are_none());
  EXPECT_EQ(sporadic->next_change(milliseconds(3)), kNever) << "no event";
  events(1);
  EXPECT_EQ(sporadic->next_change(milliseconds(3)), milliseconds(3));
  sporadic->follow(milliseconds(3));
  EXPECT_EQ(releases->task(kServed).events, 0u);
  ASSERT_TRUE(is_any_ready());
  const Job job = dispatch(milliseconds(3));
  EXPECT_EQ(job.task, kServed);
  EXPECT_EQ(job.release, milliseconds(3));
  EXPECT_EQ(job.deadline, milliseconds(13));
  EXPECT_EQ(sporadic->next_change(milliseconds(3)), milliseconds(5)) << "the capacity lasts two milliseconds";
}

TEST_F(SporadicTasksTest, TakesTheProcessorFromAJobWithoutCapacityUntilThereIsSomeAgain) {
  events(1);
  sporadic->follow(milliseconds(3));
  dispatch(milliseconds(3));
  use(milliseconds(5));
  sporadic->follow(milliseconds(5));
  EXPECT_TRUE(processor->is_idle());
  EXPECT_FALSE(is_any_ready());
  EXPECT_EQ(releases->task(kServed).profile.exhausted, 1u);
  EXPECT_EQ(releases->task(kServed).profile.preempted, 1u);
  EXPECT_EQ(sporadic->next_change(milliseconds(5)), milliseconds(13)) << "one period after the job began";
  sporadic->follow(milliseconds(12));
  EXPECT_FALSE(is_any_ready());
  sporadic->follow(milliseconds(13));
  ASSERT_TRUE(is_any_ready());
  const Job again = dispatch(milliseconds(13));
  EXPECT_EQ(again.release, milliseconds(3));
  EXPECT_EQ(again.deadline, milliseconds(23));
}

TEST_F(SporadicTasksTest, AnswersEventsInTurn) {
  events(2);
  sporadic->follow(milliseconds(3));
  dispatch(milliseconds(3));
  use(milliseconds(4));
  sporadic->follow(milliseconds(4));
  EXPECT_EQ(releases->task(kServed).events, 1u);
  EXPECT_FALSE(is_any_ready());
  processor->take();
  processor->of(kServed).has_begun = false;
  sporadic->finish(kServed);
  sporadic->follow(milliseconds(4));
  ASSERT_TRUE(is_any_ready());
  EXPECT_EQ(dispatch(milliseconds(4)).release, milliseconds(4));
}

TEST_F(SporadicTasksTest, LosesTheEventOfATaskThatIsNotOnAnyMore) {
  events(1);
  sporadic->follow(milliseconds(3));
  ASSERT_TRUE(is_any_ready());
  releases->task(kServed).state = State::kOff;
  releases->members().follow(releases->task(kServed), milliseconds(4));
  sporadic->follow(milliseconds(4));
  EXPECT_FALSE(is_any_ready());
  EXPECT_EQ(releases->task(kServed).profile.events_lost, 1u);
}

TEST_F(SporadicTasksTest, AJobThatWasDemotedUsesNoCapacity) {
  events(1);
  sporadic->follow(milliseconds(3));
  dispatch(milliseconds(3));
  processor->of(kServed).is_demoted = true;
  use(milliseconds(9));
  EXPECT_EQ(sporadic->next_change(milliseconds(9)), kNever);
  sporadic->follow(milliseconds(9));
  EXPECT_EQ(processor->running(), kServed);
  processor->of(kServed).is_demoted = false;
  EXPECT_EQ(sporadic->next_change(milliseconds(9)), milliseconds(11)) << "all of it is left";
}

TEST_F(SporadicTasksTest, OnlyThoseBehindAServerHaveNoDeadlineOfTheirOwn) {
  const Job job{kServed, milliseconds(3), milliseconds(13)};
  EXPECT_EQ(sporadic->without_server(job).deadline, kNever);
  EXPECT_EQ(sporadic->without_server({kPeriodic, milliseconds(3), milliseconds(13)}).deadline, milliseconds(13));
  sporadic->charge(kPeriodic, milliseconds(1));
  sporadic->finish(kPeriodic);
}

}  // namespace
}  // namespace chimera
