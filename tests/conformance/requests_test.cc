// SPDX-License-Identifier: Apache-2.0
// Requests of tasks for a configuration, on every executor of one context: the last request counts, none is lost during
// a switch, and a request that changes nothing has no effect.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/runner.h"

namespace chimera::toy::requests_test {
namespace {

/// Actions of the components of a run. One run at a time.
struct Scene {
  std::function<void(Cycle)> first, second;  // in the cycles of the two that ask
  std::function<Outcome(Cycle)> on_of_high;
  std::vector<bool> answers;
};
Scene scene;

struct First {
  Out<double> x{"x", "1", initial = 0.0};
  void cycle(Cycle c) {
    if (scene.first) scene.first(c);
  }
};

struct Second {
  In<double> x{"x", "1"};
  void cycle(Cycle c) {
    if (scene.second) scene.second(c);
  }
};

struct Low {
  Out<double> level{"level", "1", initial = 0.0};
  void cycle(Cycle) { *level = 1; }
};

struct High {
  Out<double> level{"level", "1", initial = 0.0};
  Outcome on(Cycle c) { return scene.on_of_high ? scene.on_of_high(c) : ok(); }
  void cycle(Cycle) { *level = 1; }
};

constexpr TaskId kFirst{0u}, kSecond{1u}, kLow{2u}, kHigh{3u}, kOther{4u};
constexpr std::uint32_t kLowSet = 0, kHighSet = 1, kOtherSet = 2;

class Requests : public OneContext {
 protected:
  Requests() { scene = {}; }
  void describe(testing::TestApplication& app) override {
    app.add("first", testing::component<First>("first")).budget = microseconds(20);
    app.add("second", testing::component<Second>("second")).budget = microseconds(20);
    app.add("low", testing::component<Low>("low")).budget = microseconds(20);
    app.add("high", testing::component<High>("high")).budget = microseconds(20);
    app.add("other", testing::component<Low>("low")).budget = microseconds(20);
    for (TaskSpec& task : app.tasks) task.rtpu = RtpuId{0u};
    if (change_) change_(app);
    app.make({kFirst, kSecond, kLow}, false);
    app.spec.sets = std::span(sets_).first(n_sets_);
  }
  std::span<const SwitchReceipt> go(Nanoseconds duration, const std::vector<ScriptAct>& acts = {}) {
    const auto receipts = OneContext::go(duration, acts);
    for (const Task& task : set_->tasks())
      EXPECT_EQ(task.profile.dropped + task.profile.missed, 0u) << task.spec->name;
    return receipts;
  }
  static void ask(const Cycle& c, const char* name) { scene.answers.push_back(c.request(name)); }

  std::vector<TaskId> low_{kFirst, kSecond, kLow}, high_{kFirst, kSecond, kHigh}, other_{kFirst, kSecond, kOther};
  NamedSet sets_[3] = {{"low", low_}, {"high", high_}, {"other", other_}};
  std::size_t n_sets_ = 3;
  std::function<void(testing::TestApplication&)> change_;
};

INSTANTIATE_TEST_SUITE_P(All, Requests, kEachExecutor, name_of_kind);

// `high` has its first cycle half a second after the change. The next request does not wait for it.
TEST_P(Requests, DoNotWaitForFirstCycles) {
  change_ = [](testing::TestApplication& app) {
    app.tasks[kHigh.index].period = app.tasks[kHigh.index].deadline = seconds(1);
    app.tasks[kHigh.index].offset = milliseconds(500);
  };
  scene.first = [](Cycle c) {
    if (c.count() == 5) ask(c, "high");
    if (c.count() == 20) ask(c, "low");
  };
  const auto receipts = go(milliseconds(100));
  ASSERT_EQ(receipts.size(), 2u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[1].end, SwitchEnd::kDone);
  EXPECT_LE(receipts[1].at, milliseconds(25));
  EXPECT_TRUE(is_on(kLow));
}

TEST_P(Requests, RepeatsARefusedRequestTenTimesASecondAndTakesAnotherAtOnce) {
  scene.on_of_high = [](Cycle) { return fault("no"); };
  scene.first = [](Cycle c) { (void)c.request(c.count() == 270 ? "other" : "high"); };
  const auto receipts = go(milliseconds(300));
  ASSERT_EQ(receipts.size(), 5u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_EQ(receipts[i].end, SwitchEnd::kRefused);
    EXPECT_EQ(receipts[i].why, NoSwitch::kInError);
    EXPECT_GE(receipts[i].asked - receipts[i - 1].asked, milliseconds(100));
    EXPECT_LE(receipts[i].asked - receipts[i - 1].asked, milliseconds(102));
  }
  EXPECT_EQ(receipts[3].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[3].after, kOtherSet);
  EXPECT_LT(receipts[3].at, milliseconds(272));
  EXPECT_LT(receipts[4].asked, milliseconds(273)) << "the request before was for another set";
  EXPECT_TRUE(is_on(kOther));
}

TEST_P(Requests, ASecondRequestRepeatsARefusedSwitch) {
  scene.on_of_high = [](Cycle) { return fault("no"); };
  scene.first = [](Cycle c) {
    if (c.count() == 10 || c.count() == 20) ask(c, "high");
  };
  const auto receipts = go(milliseconds(200));
  ASSERT_EQ(receipts.size(), 2u);
  EXPECT_GE(receipts[1].asked - receipts[0].asked, milliseconds(100));
  EXPECT_LE(receipts[1].asked - receipts[0].asked, milliseconds(102));
}

TEST_P(Requests, AreCarriedOutBehindTheCycleThatAsked) {
  scene.first = [](Cycle c) {
    if (c.count() == 5) ask(c, "high");
  };
  const auto receipts = go(milliseconds(10));
  ASSERT_EQ(receipts.size(), 1u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[0].cause, SwitchCause::kRequest);
  EXPECT_EQ(receipts[0].by, kFirst);
  EXPECT_EQ(receipts[0].after, kHighSet);
  EXPECT_GE(receipts[0].asked, milliseconds(5));
  EXPECT_LT(receipts[0].at, milliseconds(6));
  EXPECT_TRUE(is_on(kHigh));
  EXPECT_FALSE(is_on(kLow));
  EXPECT_EQ(set_->tasks()[kLow.index].profile.cycles, 6u);
  EXPECT_EQ(set_->tasks()[kHigh.index].profile.cycles, 4u);
  EXPECT_EQ(scene.answers, std::vector<bool>{true});
}

TEST_P(Requests, TheLastOfAMethodCounts) {
  scene.first = [](Cycle c) {
    if (c.count() != 5) return;
    ask(c, "high");
    ask(c, "other");
  };
  const auto receipts = go(milliseconds(10));
  ASSERT_EQ(receipts.size(), 1u);
  EXPECT_EQ(receipts[0].after, kOtherSet);
}

TEST_P(Requests, ARequestForTheSetInForceOrUnderWayHasNoEffect) {
  scene.on_of_high = [](Cycle c) {
    c.spend(microseconds(1500));  // the releases during `on` come before the change
    return ok();
  };
  scene.first = [](Cycle c) {
    if (c.count() == 2) ask(c, "low");
    if (c.count() == 5 || c.count() == 6) ask(c, "high");
  };
  const auto receipts = go(milliseconds(12));
  ASSERT_EQ(receipts.size(), 1u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(scene.answers, (std::vector<bool>{true, true, true}));
}

TEST_P(Requests, DuringASwitchTheLastRequestIsCarriedOutNext) {
  scene.on_of_high = [](Cycle c) {
    c.spend(microseconds(1500));
    return ok();
  };
  scene.first = [](Cycle c) {
    if (c.count() == 5) ask(c, "high");
    if (c.count() == 6) ask(c, "low");
  };
  scene.second = [](Cycle c) {
    if (c.count() == 6) ask(c, "other");
  };
  const auto receipts = go(milliseconds(15));
  ASSERT_EQ(receipts.size(), 2u);
  EXPECT_EQ(receipts[0].after, kHighSet);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[1].after, kOtherSet);
  EXPECT_EQ(receipts[1].by, kSecond);
  EXPECT_EQ(receipts[1].end, SwitchEnd::kDone);
  EXPECT_GE(receipts[1].asked, receipts[0].ended);
  EXPECT_TRUE(is_on(kOther));
}

TEST_P(Requests, ARequestOfAnArmedTaskIsSentAtTheChangeOnly) {
  scene.on_of_high = [](Cycle c) {
    ask(c, "other");
    return ok();
  };
  const auto receipts = go(milliseconds(15), {to(kHighSet, microseconds(5500))});
  ASSERT_EQ(receipts.size(), 2u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[1].by, kHigh);
  EXPECT_TRUE(is_on(kOther));
  scene.on_of_high = [](Cycle c) -> Outcome {
    ask(c, "other");
    return fault("no current");
  };
  const auto again = go(milliseconds(15), {to(kHighSet, microseconds(5500))});
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].end, SwitchEnd::kAborted);
  EXPECT_TRUE(is_on(kLow));
}

TEST_P(Requests, LeaveATaskOffThatAPersonTurnedOffUntilAPersonTurnsItOn) {
  scene.first = [](Cycle c) {
    if (c.count() == 8 || c.count() == 25) ask(c, "high");
    if (c.count() == 10) scene.answers.push_back(c.signal(Signal::kOn, "second"));
  };
  const auto person = [](Nanoseconds at, Signal signal) {
    return ScriptAct{at, ScriptAct::Kind::kSignal, signal, kSecond};
  };
  const auto receipts =
      go(milliseconds(150), {person(milliseconds(5), Signal::kOff), person(milliseconds(12), Signal::kOn)});
  ASSERT_EQ(receipts.size(), 2u);
  EXPECT_EQ(receipts[0].why, NoSwitch::kKeptOff);
  EXPECT_EQ(receipts[0].task, kSecond);
  EXPECT_EQ(receipts[1].end, SwitchEnd::kDone);
  ASSERT_EQ(runner_->refused().size(), 1u);
  EXPECT_EQ(runner_->refused()[0].why, Refusal::kKeptOff);
  EXPECT_EQ(scene.answers, std::vector<bool>(3, true));
  EXPECT_TRUE(is_on(kSecond) && is_on(kHigh));
}

TEST_P(Requests, LeaveATaskOffThatAPersonNamedBehindOff) {
  scene.first = [](Cycle c) {
    if (c.count() == 8) ask(c, "low");
  };
  ScriptAct act = to(kHighSet, milliseconds(5));
  act.set = UINT32_MAX;
  TaskLists lists;
  lists.plus.add(kHigh);
  lists.minus.add(kLow);
  act.lists = &lists;
  const auto receipts = go(milliseconds(20), {act, to(kLowSet, milliseconds(15))});
  ASSERT_EQ(receipts.size(), 3u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[1].why, NoSwitch::kKeptOff);
  EXPECT_EQ(receipts[2].end, SwitchEnd::kDone) << "a person switches";
}

TEST_P(Requests, ForAnUnknownConfigurationAreRefusedCountedAndNotedOnce) {
  scene.first = [](Cycle c) {
    if (c.count() % 2 == 0) ask(c, "hihg");
  };
  EXPECT_TRUE(go(milliseconds(6)).empty());
  EXPECT_EQ(scene.answers, (std::vector<bool>{false, false, false}));
  const Task& task = set_->tasks()[kFirst.index];
  EXPECT_EQ(task.requests_refused, 3u);
  EXPECT_EQ(task.faults.notes, 1u);
  EXPECT_STREQ(task.faults.note, "asks for the configuration 'hihg': there is none of this name");
}

TEST_P(Requests, ARequestForTasksDependsOnTheTasksThatAreOn) {
  scene.first = [](Cycle c) {
    if (c.count() == 3) ask(c, "--on high");
    if (c.count() == 4 || c.count() == 8) ask(c, "--on high --off low");  // at 4 under way, at 8 in force
    if (c.count() == 12) ask(c, "--off second");
    if (c.count() == 20) ask(c, "--on low --off high");
  };
  const auto receipts = go(milliseconds(30), {to(kOtherSet, milliseconds(25))});
  EXPECT_EQ(scene.answers, std::vector<bool>(5, true));
  ASSERT_EQ(receipts.size(), 4u);
  EXPECT_EQ(receipts[0].after, kHighSet) << "`high` alone: its rival producer goes OFF";
  EXPECT_EQ(receipts[0].cause, SwitchCause::kRequest);
  EXPECT_EQ(receipts[0].by, kFirst);
  EXPECT_EQ(receipts[1].after, kNoSet) << "it is no configuration";
  EXPECT_EQ(receipts[2].before, kNoSet);
  for (const SwitchReceipt& receipt : receipts) EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_TRUE(runner_->asked().refused().empty());
}

TEST_P(Requests, ForTasksThatAreNoLegalSetAreRefusedAndKept) {
  scene.first = [](Cycle c) {
    if (c.count() == 3) ask(c, "--on high low");
    if (c.count() == 4) ask(c, "--on hihg");
  };
  EXPECT_TRUE(go(milliseconds(10)).empty());
  EXPECT_EQ(scene.answers, (std::vector<bool>{true, false}));
  EXPECT_STREQ(set_->tasks()[kFirst.index].faults.note, "asks for '--on hihg': there is no task 'hihg'");
  ASSERT_EQ(runner_->asked().refused().size(), 1u);
  const RefusedLists& refused = runner_->asked().refused()[0];
  EXPECT_EQ(refused.request.by, kFirst);
  EXPECT_EQ(refused.why, "level would have two producers: low and high");
  EXPECT_TRUE(is_on(kLow));
}

TEST_P(Requests, MayTurnOffATaskOfTheOnlyConfiguration) {
  n_sets_ = 1;
  scene.first = [](Cycle c) {
    if (c.count() == 3) ask(c, "--off second");
  };
  const auto receipts = go(milliseconds(10));
  ASSERT_EQ(receipts.size(), 1u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_FALSE(is_on(kSecond));
}

TEST_P(Requests, WhereThereIsOneConfigurationAreRefused) {
  n_sets_ = 1;
  scene.first = [](Cycle c) { ask(c, "low"); };
  EXPECT_TRUE(go(milliseconds(2)).empty());
  EXPECT_EQ(scene.answers, (std::vector<bool>{false, false}));
  EXPECT_STREQ(set_->tasks()[kFirst.index].faults.note, "asks for the configuration 'low': it is the only one");
}

TEST_P(Requests, AreNotMadeByAFaultThatLeavesFlag) {
  change_ = [](testing::TestApplication& app) { app.tasks[kSecond.index].on_fault = OnFault::kFlag; };
  scene.second = [](Cycle c) {
    if (c.count() == 3) throw "blind";
  };
  const ScriptAct clear{milliseconds(6), ScriptAct::Kind::kSignal, Signal::kClear, kSecond};
  EXPECT_TRUE(go(milliseconds(5), {clear}).empty());
  EXPECT_EQ(set_->tasks()[kSecond.index].state, chimera::State::kError);
  EXPECT_TRUE(set_->flag().is_on_set_legal()) << "no task reads its output";
  EXPECT_TRUE(set_->flag().is_up());
  EXPECT_EQ(runner_->run(milliseconds(7)), RunEnd::kTime);
  EXPECT_FALSE(set_->flag().is_up()) << "no longer in ERROR";
}

TEST_P(Requests, AreNotMadeByAFaultThatStopsTheRun) {
  change_ = [](testing::TestApplication& app) { app.tasks[kSecond.index].on_fault = OnFault::kStop; };
  scene.second = [](Cycle c) {
    if (c.count() == 3) throw "blind";
  };
  end_ = RunEnd::kTaskStopped;
  EXPECT_TRUE(go(milliseconds(10)).empty());
  EXPECT_EQ(set_->tasks()[kFirst.index].profile.cycles, 4u);
}

TEST_P(Requests, BeyondTheReceiptsThatAreKeptAreCarriedOutAndCounted) {
  scene.first = [](Cycle c) {
    if (c.count() % 4 == 0) ask(c, c.count() % 8 == 0 ? "high" : "low");
  };
  const auto receipts = go(milliseconds(160));
  ASSERT_EQ(receipts.size(), 16u);
  EXPECT_EQ(runner_->kept().left_out(), 24u);
  EXPECT_EQ(receipts[14].number, 15u);
  EXPECT_EQ(receipts[15].number, 40u);
  for (const SwitchReceipt& receipt : receipts) EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_TRUE(is_on(kLow));
}

}  // namespace
}  // namespace chimera::toy::requests_test
