// SPDX-License-Identifier: Apache-2.0
// Switches on every executor of one context in which two tasks of a loop are exchanged, or a method of a task fits no
// idle gap.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

std::vector<double> seen;  // values that the reader read in each cycle
Nanoseconds off_at = kNever;

struct Link {  // publishes its input
  In<double> x{"x", "1"};
  Out<double> y{"y", "1", initial = 1.0};
  void on(Cycle) { *y = *x; }
  void cycle(Cycle) { *y = *x; }
};

struct Five {
  In<double> x{"x", "1"};
  Out<double> y{"y", "1", initial = 5.0};
  void cycle(Cycle) { *y = 5; }
};

struct Reader {
  In<double> v{"v1", "1"};
  Out<double> s{"s", "1", initial = 0.0};
  void cycle(Cycle) {
    *s = *v;
    seen.push_back(*v);
  }
};

struct Busy {
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle) { *y = 1; }
  void off(Cycle c) { off_at = c.now(); }
};

class SwitchLoops : public ::testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    seen.clear();
    off_at = kNever;
  }
  /// From the first set to the second at 5.3 ms.
  const SwitchReceipt& go(Nanoseconds duration) {
    app_.make(sets_[0], false);
    named_ = {{"first", sets_[0]}, {"second", sets_[1]}};
    app_.spec.sets = named_;
    set_ = *HeapTaskSet::create(app_.spec, app_.components);
    ScriptAct act;
    act.at = microseconds(5300);
    act.kind = ScriptAct::Kind::kSwitch;
    act.set = 1;
    acts_ = {act};
    runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
    EXPECT_TRUE(runner_->start());
    if (known_off_ > Nanoseconds{}) set_->tasks()[sets_[0].back().index].profile.add_call(Method::kOff, known_off_);
    EXPECT_EQ(runner_->run(duration), RunEnd::kTime);
    EXPECT_EQ(runner_->receipts().size(), 1u);
    return runner_->receipts()[0];
  }
  TaskId add(const char* name, const chimera_component* component, Nanoseconds period, Nanoseconds budget) {
    app_.add(name, component, period).budget = budget;
    return TaskId(app_.tasks.size() - 1);
  }
  TaskId add_link(const char* name, const chimera_component* component, const char* x, const char* y) {
    const TaskId task = add(name, component, milliseconds(1), microseconds(20));
    app_.link(task.index, 0, x);
    app_.link(task.index, 1, y);
    return task;
  }
  /// Two tasks at 1 kHz that leave gaps of 450 us, and one whose budget fits none of them.
  void add_gapless() {
    const TaskId a = add("a", testing::component<Busy>("busy"), milliseconds(1), microseconds(50));
    const TaskId b = add("b", testing::component<Busy>("busy"), milliseconds(1), microseconds(50));
    const TaskId old = add("old", testing::component<Busy>("busy"), milliseconds(10), microseconds(880));
    app_.link(b.index, 0, "yb");
    app_.link(old.index, 0, "yc");
    app_.tasks[b.index].offset = microseconds(500);
    sets_[0] = {a, b, old};
    sets_[1] = {a, b};
  }

  static void expect_off_within_100_ms(const SwitchReceipt& receipt) {
    ASSERT_EQ(receipt.end, SwitchEnd::kDone);
    const bool waits = GetParam() != Kind::kPreemptive;
    EXPECT_GE(off_at, receipt.at + (waits ? milliseconds(100) : Nanoseconds{}));
    EXPECT_LE(off_at, receipt.at + milliseconds(waits ? 102 : 2));
  }

  Nanoseconds known_off_;  // what an earlier `off` of the last task of the first set took; 0: there was none
  testing::TestApplication app_;
  std::vector<TaskId> sets_[2];
  std::vector<NamedSet> named_;
  std::vector<ScriptAct> acts_;
  std::unique_ptr<HeapTaskSet> set_;
  std::unique_ptr<Runner> runner_;
};

INSTANTIATE_TEST_SUITE_P(All, SwitchLoops, kEachExecutor, name_of_kind);

TEST_P(SwitchLoops, ExchangedTasksOfALoopArmWithTheValuesThatStand) {
  const TaskId p1a = add_link("p1a", testing::component<Five>("five"), "v2", "v1");
  const TaskId p2a = add_link("p2a", testing::component<Five>("five"), "v1", "v2");
  const TaskId p1b = add_link("p1b", testing::component<Link>("link"), "v2", "v1");
  const TaskId p2b = add_link("p2b", testing::component<Link>("link"), "v1", "v2");
  const TaskId reader = add("reader", testing::component<Reader>("reader"), milliseconds(1), microseconds(20));
  sets_[0] = {p1a, p2a, reader};
  sets_[1] = {p1b, p2b, reader};
  const SwitchReceipt& receipt = go(milliseconds(20));
  ASSERT_EQ(receipt.end, SwitchEnd::kDone) << static_cast<int>(receipt.why);
  EXPECT_EQ(seen, std::vector<double>(20, 5.0));
  ASSERT_EQ(receipt.variables.size(), 2u);
  for (const VariablePart& part : receipt.variables) EXPECT_EQ(part.step_of_on.size, 0);
}

TEST_P(SwitchLoops, OffThatWasNeverCalledWaitsForAGapForAHundredMilliseconds) {
  add_gapless();
  expect_off_within_100_ms(go(milliseconds(300)));
}

TEST_P(SwitchLoops, OffThatIsKnownToFitNoGapWaitsForAHundredMilliseconds) {
  add_gapless();
  known_off_ = microseconds(880);
  expect_off_within_100_ms(go(milliseconds(300)));
}

TEST_P(SwitchLoops, OnlyAContextWithoutPreemptionNeedsAGapForOn) {
  const TaskId stays = add("stays", testing::component<Busy>("busy"), milliseconds(1), microseconds(30));
  const TaskId heavy = add("heavy", testing::component<Busy>("busy"), milliseconds(10), milliseconds(3));
  app_.link(heavy.index, 0, "yb");
  for (TaskSpec& task : app_.tasks) task.on_miss = OnMiss::kAbort;  // no deadline is judged
  sets_[0] = {stays};
  sets_[1] = {stays, heavy};
  const SwitchReceipt& receipt = go(milliseconds(300));
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(receipt.way.slow, GetParam() == Kind::kPreemptive ? 0 : kSlowForGap);
  EXPECT_LE(receipt.at - receipt.asked, milliseconds(3));
}

// As with `run --isolation none` of a description with two rtpus.
TEST_P(SwitchLoops, TasksOfTwoRtpusInOneContextArmInOneTurn) {
  app_.rtpus = {{"main", 0, Policy::kEdf}, {"other", 1, Policy::kEdf}};
  for (const char* name : {"a", "b", "c", "d"}) {
    const TaskId task = add(name, testing::component<Busy>("busy"), milliseconds(1), microseconds(20));
    app_.link(task.index, 0, name);
    app_.tasks[task.index].rtpu = RtpuId(task.index % 2);
    sets_[task.index / 2].push_back(task);
  }
  const SwitchReceipt& receipt = go(milliseconds(50));
  ASSERT_EQ(receipt.end, SwitchEnd::kDone) << static_cast<int>(receipt.why);
  EXPECT_LE(receipt.at - receipt.asked, milliseconds(1));
}

}  // namespace
}  // namespace chimera::toy
