// SPDX-License-Identifier: Apache-2.0
// The background of components: from the end of init to kill, in any thread.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include "chimera/base/testing/await.h"
#include "chimera/runtime/hosted/background_writer.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/virtual_executor.h"

namespace chimera::task_set_background_test {
namespace {

// Calls of the one instance of a test, in letters: i b(ackground) c k d(estroyed).
struct Story {
  std::string letters;                 // of the thread that signals
  std::atomic<int> backgrounds{0};
  std::atomic<bool> is_stalled{false};
  bool throws = false;
};
Story* story = nullptr;

struct Writer {
  Out<double> x{"x", "1", initial = 0.0};
  void init() { story->letters += 'i'; }
  void cycle() {
    ++cycles_;
    story->letters += 'c';
  }
  void kill() { story->letters += 'k'; }
  void background() {
    Story& mine = *story;  // of the test that began it, however long it takes
    const int seen = mine.backgrounds++;
    if (mine.throws && seen == 2) throw std::runtime_error("the disk burns");
    while (mine.is_stalled) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ~Writer() {
    if (cycles_ >= 0 && story != nullptr) story->letters += 'd';
  }
  int cycles_ = 0;
};

struct TaskSetBackground : ::testing::Test {
  Story told;
  chimera::testing::TestApplication app;
  BackgroundWriter writer{milliseconds(1), kHangLimit};
  std::unique_ptr<HeapTaskSet> set;

  void make() {
    app.add("w", chimera::testing::component<Writer>("writer"));
    auto made = HeapTaskSet::create(app.make(), app.components);
    ASSERT_TRUE(made);
    set = *std::move(made);
    told.letters.clear();
    story = &told;
  }
  ~TaskSetBackground() override {
    set.reset();
    story = nullptr;
  }
  void await(int backgrounds) {
    ASSERT_TRUE(await_that([&] { return told.backgrounds >= backgrounds; }));
  }
  const Task& task() { return set->tasks()[0]; }
};

TEST_F(TaskSetBackground, RunsInAThreadFromInitToKill) {
  make();
  set->methods().run_by({nullptr, nullptr, &writer});
  EXPECT_TRUE(set->life().signal(TaskId{0u}, Signal::kSpawn, {}).is_accepted);
  await(3);
  EXPECT_TRUE(set->life().signal(TaskId{0u}, Signal::kKill, {}).is_accepted);
  const int at_kill = told.backgrounds;
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(told.backgrounds, at_kill);
  EXPECT_EQ(told.letters, "ikd");
  EXPECT_EQ(task().faults.count, 0u);
}

TEST_F(TaskSetBackground, WithoutAThreadItRunsOnceBeforeKill) {
  make();
  set->life().signal(TaskId{0u}, Signal::kSpawn, {});
  EXPECT_EQ(told.backgrounds, 0);
  set->life().signal(TaskId{0u}, Signal::kKill, {});
  EXPECT_EQ(told.backgrounds, 1);
  EXPECT_EQ(told.letters, "ikd");
}

TEST_F(TaskSetBackground, ATaskThatIsNeverKilledIsLeftByItsThreadBeforeItGoes) {
  make();
  set->methods().run_by({nullptr, nullptr, &writer});
  set->life().signal(TaskId{0u}, Signal::kSpawn, {});
  await(1);
  set.reset();
  EXPECT_EQ(told.letters, "id");
}

TEST_F(TaskSetBackground, AStalledOneIsLeftAloneAndTheTaskCanBeMadeAnew) {
  static Story for_ever;  // the stalled thread looks at it until the end of the process
  make();
  story = &for_ever;
  for_ever.is_stalled = true;
  BackgroundWriter impatient{milliseconds(1), milliseconds(100)};
  set->methods().run_by({nullptr, nullptr, &impatient});
  set->life().signal(TaskId{0u}, Signal::kSpawn, {});
  ASSERT_TRUE(await_that([] { return for_ever.backgrounds > 0; }));
  const SignalReport report = set->life().signal(TaskId{0u}, Signal::kKill, {});
  EXPECT_EQ(report.after, State::kNotCreated);
  EXPECT_EQ(for_ever.letters, "i");  // neither killed nor destroyed
  EXPECT_STREQ(task().faults.last.text, "its background did not return within 0.1 s: what it holds is lost");
  const int begun = for_ever.backgrounds;
  for_ever.is_stalled = false;
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(for_ever.backgrounds, begun) << "an abandoned background is not called again";
  for_ever.letters.clear();
  set->methods().run_by({nullptr, nullptr, &writer});
  EXPECT_TRUE(set->life().signal(TaskId{0u}, Signal::kSpawn, {}).is_accepted);
  EXPECT_TRUE(set->life().signal(TaskId{0u}, Signal::kKill, {}).is_accepted);
  EXPECT_EQ(for_ever.letters, "ikd");
}

TEST_F(TaskSetBackground, AFaultIsReportedAtKillOnly) {
  make();
  told.throws = true;
  set->methods().run_by({nullptr, nullptr, &writer});
  set->life().signal(TaskId{0u}, Signal::kSpawn, {});
  await(3);
  set->life().signal(TaskId{0u}, Signal::kKill, {});
  EXPECT_EQ(told.backgrounds, 3);
  EXPECT_EQ(told.letters, "ikd");
  EXPECT_STREQ(task().faults.last.text, "the disk burns");
  EXPECT_EQ(task().faults.method, Method::kKill);
}

TEST_F(TaskSetBackground, InVirtualTimeItRunsAfterEachCycle) {
  for (const bool preemptive : {false, true}) {
    set.reset();
    story = nullptr;
    app = {};
    told.backgrounds = 0;
    make();
    VirtualExecutor executor(*set, {}, {.preemptive = preemptive, .times = {}});
    ASSERT_TRUE(executor.start());
    executor.run(milliseconds(5));
    EXPECT_EQ(told.letters, "iccccc");
    EXPECT_EQ(told.backgrounds, 5);
    executor.shut_down();
    EXPECT_EQ(told.backgrounds, 6);
  }
}

TEST_F(TaskSetBackground, AFaultInVirtualTimeIsOneOfItsCycle) {
  make();
  told.throws = true;
  VirtualExecutor executor(*set, {}, {});
  ASSERT_TRUE(executor.start());
  executor.run(milliseconds(5));
  EXPECT_EQ(told.backgrounds, 3);
  EXPECT_STREQ(task().faults.last.text, "the disk burns");
  EXPECT_EQ(task().faults.method, Method::kCycle);
  EXPECT_EQ(task().state, State::kOn);
}

}  // namespace
}  // namespace chimera::task_set_background_test
