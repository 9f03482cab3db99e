// SPDX-License-Identifier: Apache-2.0
// The execution time of a task (docs/decisions/0026-instructions-of-a-job.md): no value is copied outside of it.
// Durations are not judged: the clock of the test looks at the memory each time it is read.
#include <gtest/gtest.h>

#include <limits>

#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::testing {
namespace {

struct Wide {
  Out<double[16]> wide{"wide", "1", initial = 0.0};
  void on(Cycle) { wide[1] = 100; }
  void cycle(Cycle) { wide[0] = ++n_; }
  void off(Cycle) { wide[2] = 7; }
  double n_ = 0;
};

struct Reader {
  In<double[16]> wide{"wide", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  void cycle(Cycle) { *seen = wide[0]; }
};

struct Guarded {
  Out<double> guarded{"guarded", "1", safety, initial = 0.0};
  void cycle(Cycle) { *guarded = ++n_ < 3 ? n_ : std::numeric_limits<double>::quiet_NaN(); }
  bool error(Cycle) { return true; }
  double n_ = 0;
};

constexpr std::size_t kValues = 16 * sizeof(double);

// The values of the latest publication and of the slot that comes next, as they are at one reading of a clock.
struct Look {
  std::uint64_t sequence = 0;
  double latest[16] = {}, staged[16] = {};
};

class LookingClock final : public Clock {
 public:
  void watch(const Task& task) { task_ = &task; }
  Nanoseconds now() noexcept override {
    if (task_->group.payload_bytes() == kValues) {
      Look& look = looks.emplace_back();
      look.sequence = task_->group.sequence();
      std::memcpy(look.latest, task_->group.published() + 1, kValues);
      std::memcpy(look.staged, task_->group.staging(), kValues);
    }
    return time_ += Nanoseconds{1};
  }
  WaitEnd wait_until(Nanoseconds instant) noexcept override {
    time_ = std::max(time_, instant);
    return WaitEnd::kReached;
  }
  std::vector<Look> looks;

 private:
  const Task* task_ = nullptr;
  Nanoseconds time_;
};

struct ExecutionTime : ::testing::Test {
  void make() {
    app.make();
    auto made = HeapTaskSet::create(app.spec, app.components);
    ASSERT_TRUE(made) << made.error().message.view();
    set = *std::move(made);
    clock.watch(set->tasks()[0]);
  }
  TestApplication app;
  std::unique_ptr<HeapTaskSet> set;
  LookingClock clock;
  ComputingClock job_clock{clock};
};

// Two readings with one publication between them: the end of the job, and the next reading after it.
TEST_F(ExecutionTime, IncludesEveryCopyOfTheOutputsOfAJob) {
  app.add("wide", component<Wide>("wide"));
  app.port(0, 0).extent[0].max = 16;
  app.add("reader", component<Reader>("reader"));
  app.port(1, 0).extent[0].max = 16;
  make();
  Executive executive(*set, clock, job_clock, {});
  ASSERT_TRUE(executive.start());
  clock.looks.clear();
  executive.run(milliseconds(10));
  int publications = 0;
  for (std::size_t i = 1; i < clock.looks.size(); ++i) {
    const Look& end = clock.looks[i - 1];
    const Look& next = clock.looks[i];
    if (next.sequence != end.sequence + 1) continue;
    ++publications;
    EXPECT_EQ(end.staged[0], publications) << "the body has run";
    EXPECT_EQ(end.staged[1], 100) << "unwritten outputs were staged before";
    EXPECT_EQ(std::memcmp(end.staged, next.latest, kValues), 0);
    EXPECT_NE(next.staged[0], next.latest[0]) << "the next outputs are staged in the time of the next job";
  }
  EXPECT_GE(publications, 8);
}

TEST_F(ExecutionTime, IncludesTheTransfersOfAMethod) {
  app.add("wide", component<Wide>("wide"));
  app.port(0, 0).extent[0].max = 16;
  make();
  set->methods().run_by({&job_clock});
  ASSERT_TRUE(set->life().start({}));
  clock.looks.clear();
  set->life().signal(TaskId(0u), Signal::kOff, {});
  ASSERT_EQ(clock.looks.size(), 2u) << "its begin and its end";
  EXPECT_NE(clock.looks[0].staged[1], 100) << "staged within the time";
  EXPECT_EQ(clock.looks[1].latest[1], 100);
  EXPECT_EQ(clock.looks[1].latest[2], 7) << "published within the time";
  EXPECT_EQ(clock.looks[1].sequence, clock.looks[0].sequence + 1);
  EXPECT_EQ(set->tasks()[0].profile.execution[CHIMERA_OFF].count, 1u);
}

TEST_F(ExecutionTime, IncludesErrorCalledByACycle) {
  app.add("guarded", component<Guarded>("guarded"));
  make();
  Executive executive(*set, clock, job_clock, {});
  ASSERT_TRUE(executive.start());
  executive.run(milliseconds(10));
  const Task& task = set->tasks()[0];
  EXPECT_EQ(task.profile.cycles, 2u);
  EXPECT_GE(task.profile.rejected, 5u);
  EXPECT_EQ(task.profile.execution[CHIMERA_ERROR].count, task.profile.rejected);
  EXPECT_GT(task.profile.execution[CHIMERA_ERROR].min, Nanoseconds{});
  double last;
  std::memcpy(&last, task.group.published() + 1, sizeof last);
  EXPECT_EQ(last, 2) << "the last good value stands";
}

}  // namespace
}  // namespace chimera::testing
