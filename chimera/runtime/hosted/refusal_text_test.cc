// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/refusal_text.h"

#include <gtest/gtest.h>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

struct Source {
  Out<double> x{"x", "1", initial = 0.0};
  Outcome init(Cycle) { return fails ? fault("no such device") : ok(); }
  void cycle(Cycle) {}
  static inline bool fails = false;
};

struct Sink {
  In<double> x{"x", "1"};
  void cycle(Cycle) {}
};

constexpr TaskId kSource{0u}, kSink{1u};

struct RefusalText : ::testing::Test {
  RefusalText() {
    Source::fails = false;
    app.add("source", testing::component<Source>("source"));
    app.add("sink", testing::component<Sink>("sink"));
  }
  Result<void> start(std::vector<TaskId> tasks) {
    set = *HeapTaskSet::create(app.make(std::move(tasks), false), app.components);
    return start_result(*set, set->life().start({}));
  }
  std::string refused(TaskId task, Signal signal) { return refusal_text(*set, set->life().signal(task, signal, {})); }

  testing::TestApplication app;
  std::unique_ptr<HeapTaskSet> set;
};

TEST_F(RefusalText, ARefusedStartNamesItsReason) {
  EXPECT_TRUE(start({kSource, kSink}));
  const auto illegal = start({kSink});
  ASSERT_FALSE(illegal);
  EXPECT_EQ(illegal.error().message.view(), "x would have no producer; the smallest legal set is: source sink");
  EXPECT_EQ(illegal.error().where.view(), "test") << "the name of the application";
  Source::fails = true;
  const auto failed = start({kSource, kSink});
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message.view(), "init: no such device");
  EXPECT_EQ(failed.error().where.view(), "source");
}

TEST_F(RefusalText, ARefusedSignalNamesItsReason) {
  ASSERT_TRUE(start({kSource}));
  EXPECT_EQ(refused(kSink, Signal::kOn), "");
  EXPECT_EQ(refused(kSink, Signal::kOn), "on is not legal for sink in state ON");
  (void)set->life().signal(kSink, Signal::kOff, {});
  (void)set->life().signal(kSink, Signal::kKill, {});
  (void)set->life().signal(kSource, Signal::kKill, {});
  Source::fails = true;
  const SignalReport report = set->life().start({});
  EXPECT_EQ(refusal_text(*set, report), "spawn: source: no such device");
}

}  // namespace
}  // namespace chimera
