// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/state/sources.h"

#include <gtest/gtest.h>

#include <memory>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/job/job_step.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::sources_test {
namespace {

struct First {
  Out<double> u{"u", "1", initial = 1.0};
  void cycle(Cycle) {}
};
struct Second {
  Out<double> u{"u", "1", initial = 2.0};
  void cycle(Cycle) {}
};
struct Reader {
  In<double> u{"u", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle) {}
};

constexpr TaskId kFirst{0u}, kSecond{1u}, kReader{2u};

/// The variable u goes over from the first task to the second, where tasks preempt each other.
struct SourcesTest : ::testing::Test {
  SourcesTest() {
    app.add("first", testing::component<First>("first"));
    app.add("second", testing::component<Second>("second"));
    app.add("reader", testing::component<Reader>("reader"));
    app.make({kFirst, kReader}, false);
    ContextPlace context;
    context.preemptive = true;
    set = *HeapTaskSet::create(app.spec, app.components, context);
    set->methods().run_by({&clock, nullptr, nullptr});
    EXPECT_TRUE(set->life().start(clock.time));
    handover.variable = set->memory(kReader).input_spec(0).variable;
    handover.from = {kFirst, 0};
    handover.to = {kSecond, 0};
  }
  double next_job() {
    (void)set->adopt(kReader);
    Task& task = set->tasks()[kReader.index];
    read_inputs(task);
    return *static_cast<const double*>(task.inputs[0].port->value);
  }

  struct Clock final : JobClock {
    Nanoseconds now() noexcept override { return time; }
    void spend(Nanoseconds) noexcept override {}
    Nanoseconds time = seconds(1);
  };
  Clock clock;
  testing::TestApplication app;
  std::unique_ptr<HeapTaskSet> set;
  Handover handover;
};

TEST_F(SourcesTest, AJobReleasedAfterTheChangeReadsTheNextProducer) {
  const bool nobody[3] = {};
  EXPECT_EQ(next_job(), 1);
  set->sources().begin_handover({&handover, 1});
  EXPECT_EQ(next_job(), 1);
  set->sources().hand_over(nobody);
  EXPECT_EQ(next_job(), 2);
}

TEST_F(SourcesTest, AJobReleasedBeforeTheChangeKeepsTheLastProducerAlsoWhenItBeginsLater) {
  const bool old[3] = {false, false, true};
  EXPECT_EQ(next_job(), 1);
  set->sources().begin_handover({&handover, 1});
  set->sources().hand_over(old);
  EXPECT_EQ(next_job(), 1);
  EXPECT_EQ(next_job(), 1);
  set->sources().old_job_ended(kReader);
  EXPECT_EQ(next_job(), 2);
}

}  // namespace
}  // namespace chimera::sources_test
