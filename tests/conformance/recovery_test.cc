// SPDX-License-Identifier: Apache-2.0
// Recovery on every executor of one context: standbys take over from tasks that went to ERROR, and on_fault restarts
// tasks.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

/// Actions of the components of a run, and the values that they read. One run at a time.
struct Scene {
  std::function<Outcome(Cycle)> cycle_of_first, on_of_first, clear_of_first, cycle_of_spare, on_of_spare;
  std::vector<double> u;         // values that the reader read
  std::vector<bool> illegal;     // and whether the flag was up then
  std::vector<bool> valid;       // and whether that was valid
  std::vector<std::int64_t> spare_cycles;  // instants
  int ons_of_spare = 0, offs_of_spare = 0;
  std::int64_t inherited_ns = -1;
  double inherited = -1;
  int ons_of_first = 0;
};
Scene scene;

struct First {
  Out<double> u{"u", "1", initial = 0.0};
  Outcome on(Cycle c) {
    ++scene.ons_of_first;
    return scene.on_of_first ? scene.on_of_first(c) : ok();
  }
  Outcome cycle(Cycle c) {
    const Outcome outcome = scene.cycle_of_first ? scene.cycle_of_first(c) : ok();
    *u = static_cast<double>(c.count()) + 1;
    return outcome;
  }
  Outcome clear(Cycle c) { return scene.clear_of_first ? scene.clear_of_first(c) : ok(); }
};

struct Spare {
  Out<double> u{"u", "1", initial = 0.0};
  Outcome on(Cycle c) {
    ++scene.ons_of_spare;
    scene.inherited = *u;
    scene.inherited_ns = u.inherited().count;
    return scene.on_of_spare ? scene.on_of_spare(c) : ok();
  }
  Outcome cycle(Cycle c) {
    const Outcome outcome = scene.cycle_of_spare ? scene.cycle_of_spare(c) : ok();
    *u = 100 + static_cast<double>(c.count());
    scene.spare_cycles.push_back(c.now().count);
    return outcome;
  }
  void off(Cycle) { ++scene.offs_of_spare; }
};

struct Reader {
  In<double> u{"u", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  void cycle(Cycle c) {
    *seen = *u;
    scene.u.push_back(*u);
    scene.illegal.push_back(c.illegal());
    scene.valid.push_back(u.valid());
  }
};

constexpr TaskId kFirst{0u}, kReader{1u}, kSpare{2u}, kThird{3u};
constexpr std::uint32_t kPlain = 0, kAlone = 1;

class RecoveryTest : public OneContext {
 protected:
  RecoveryTest() { scene = {}; }
  void describe(testing::TestApplication& app) override {
    app.add("first", testing::component<First>("first")).budget = microseconds(20);
    app.add("reader", testing::component<Reader>("reader")).budget = microseconds(20);
    app.add("spare", testing::component<Spare>("spare")).budget = microseconds(20);
    app.add("third", testing::component<Spare>("spare")).budget = microseconds(20);
    if (!restarts_.empty()) app.tasks[kFirst.index].on_fault = OnFault::kRestart;
    if (!restarts_.empty() && restarts_[0].then == OnFault::kSwitch) app.tasks[kFirst.index].on_fault_set = kAlone;
    app.make({kFirst, kReader}, false);
    if (limit_ > 0) app.port(kSpare.index, 0).max_step = std::as_bytes(std::span(&limit_, 1));
    app.spec.standbys = standbys_;
    app.spec.restarts = restarts_;
    app.spec.stale = stale_;
    app.spec.sets = sets_;
  }
  void fail_first_in(std::uint64_t cycle) {
    scene.cycle_of_first = [cycle](Cycle c) -> Outcome {
      return c.count() == cycle ? fault("no current") : ok();
    };
  }
  static bool was_up() { return std::find(scene.illegal.begin(), scene.illegal.end(), true) != scene.illegal.end(); }

  std::vector<StandbySpec> standbys_{{kFirst, kSpare}, {kFirst, kThird}};
  std::vector<RestartSpec> restarts_;
  std::vector<StaleSpec> stale_;
  std::vector<TaskId> plain_{kFirst, kReader}, alone_{kThird, kReader};
  NamedSet sets_[2] = {{"plain", plain_}, {"alone", alone_}};
  double limit_ = 0;  // the max_step of u where the spare writes it; 0: none
};

INSTANTIATE_TEST_SUITE_P(All, RecoveryTest, kEachExecutor, name_of_kind);

TEST_P(RecoveryTest, AStandbyTakesOverWithinItsPeriodAndTheFlagStaysDown) {
  fail_first_in(5);
  go(milliseconds(10));
  EXPECT_EQ(state(kFirst), chimera::State::kError);
  EXPECT_EQ(state(kSpare), chimera::State::kOn);
  EXPECT_EQ(state(kThird), chimera::State::kOff);
  EXPECT_EQ(task(kSpare).profile.takeovers, 1u);
  EXPECT_STREQ(task(kSpare).faults.note, "took over from 'first'");
  EXPECT_EQ(scene.inherited, 5) << "the last good output of the primary";
  EXPECT_GE(scene.inherited_ns, 900'000);
  EXPECT_LE(scene.inherited_ns, 1'000'000);
  // In the cycle of the fault, and in the next one, in which the reader comes before the standby.
  EXPECT_EQ(scene.u, (std::vector<double>{1, 2, 3, 4, 5, 5, 5, 100, 101, 102}));
  EXPECT_FALSE(was_up());
  EXPECT_FALSE(set_->flag().is_up());
}

TEST_P(RecoveryTest, ATakeoverHasAReceipt) {
  limit_ = 50;
  fail_first_in(5);
  scene.on_of_spare = [](Cycle c) -> Outcome {
    c.spend(microseconds(10));
    return ok();
  };
  go(milliseconds(10));
  ASSERT_EQ(runner_->receipts().size(), 1u);
  const SwitchReceipt& receipt = runner_->receipts()[0];
  EXPECT_EQ(receipt.number, 1u);
  EXPECT_EQ(receipt.before, kPlain);
  EXPECT_EQ(receipt.after, kPlain);
  EXPECT_EQ(receipt.cause, SwitchCause::kStandby);
  EXPECT_EQ(receipt.by, kSpare);
  EXPECT_EQ(receipt.in_place_of, kFirst);
  EXPECT_FALSE(receipt.was_death);
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(receipt.flag, Nanoseconds{});
  EXPECT_GE(receipt.at - receipt.asked, microseconds(10));
  EXPECT_LE(receipt.at - receipt.asked, milliseconds(1));
  EXPECT_GT(receipt.ended, receipt.at);
  EXPECT_LE(receipt.ended - receipt.asked, milliseconds(2));
  ASSERT_EQ(receipt.tasks.size(), 2u);
  EXPECT_EQ(receipt.tasks[0].task, kSpare);
  EXPECT_EQ(receipt.tasks[0].move, TaskMove::kArrives);
  EXPECT_EQ(receipt.tasks[0].on, microseconds(10));
  EXPECT_EQ(receipt.tasks[0].lost, 0u);
  EXPECT_GE(receipt.tasks[0].delay, Nanoseconds{});
  EXPECT_EQ(receipt.tasks[1].task, kFirst);
  EXPECT_EQ(receipt.tasks[1].move, TaskMove::kLeaves);
  ASSERT_EQ(receipt.variables.size(), 1u);
  EXPECT_EQ(receipt.variables[0].handover.from.task, kFirst);
  EXPECT_EQ(receipt.variables[0].handover.to.task, kSpare);
  EXPECT_TRUE(receipt.variables[0].step_of_on.is_known);
  EXPECT_EQ(receipt.variables[0].step_of_on.size, 0) << "it continues from the last value";
  EXPECT_EQ(receipt.variables[0].step_of_cycle.size, 95) << "from 5 to 100";
  EXPECT_TRUE(receipt.variables[0].step_of_cycle.is_beyond);
}

TEST_P(RecoveryTest, AFailedAttemptAndOneCutByTheEndHaveReceipts) {
  fail_first_in(5);
  scene.on_of_spare = [n = 0](Cycle) mutable -> Outcome { return n++ == 0 ? fault("no voltage") : ok(); };
  go(milliseconds(5) + microseconds(100));
  const bool is_begun = runner_->receipts().size() == 1;
  EXPECT_TRUE(is_begun) << runner_->receipts().size();
  runner_->shut_down();
  ASSERT_EQ(runner_->receipts().size(), 2u);
  const SwitchReceipt &failed = runner_->receipts()[0], &cut = runner_->receipts()[1];
  EXPECT_EQ(failed.end, SwitchEnd::kAborted);
  EXPECT_EQ(failed.why, NoSwitch::kOnFailed);
  EXPECT_EQ(failed.task, kSpare);
  EXPECT_EQ(failed.said.view(), "no voltage");
  EXPECT_EQ(failed.at, kNever);
  EXPECT_EQ(cut.number, 2u);
  EXPECT_EQ(cut.by, kThird);
  EXPECT_EQ(cut.in_place_of, kFirst);
  EXPECT_EQ(cut.end, SwitchEnd::kDone);
}

TEST_P(RecoveryTest, ALateTakeoverSaysHowLongTheFlagWasUp) {
  standbys_ = {{kFirst, kSpare}};
  fail_first_in(5);
  scene.on_of_spare = [n = 0](Cycle) mutable -> Outcome { return n++ < 3 ? not_yet() : ok(); };
  go(milliseconds(14));
  ASSERT_EQ(runner_->receipts().size(), 1u);
  const SwitchReceipt& receipt = runner_->receipts()[0];
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_GE(receipt.at - receipt.asked, milliseconds(3));
  EXPECT_EQ(receipt.flag, receipt.at - receipt.asked - milliseconds(1));
}

TEST_P(RecoveryTest, AStandbyThatCannotGoOnMakesPlaceForTheNext) {
  fail_first_in(5);
  scene.on_of_spare = [n = 0](Cycle) mutable -> Outcome { return n++ == 0 ? fault("no voltage") : ok(); };
  go(milliseconds(10));
  EXPECT_EQ(state(kSpare), chimera::State::kError);
  EXPECT_EQ(state(kThird), chimera::State::kOn);
  EXPECT_FALSE(was_up());
}

TEST_P(RecoveryTest, WithoutAnyThatCanTheFlagIsUpAtOnce) {
  fail_first_in(5);
  scene.on_of_spare = [](Cycle) -> Outcome { return fault("no voltage"); };
  go(milliseconds(10));
  EXPECT_EQ(state(kSpare), chimera::State::kError);
  EXPECT_EQ(state(kThird), chimera::State::kError);
  EXPECT_TRUE(set_->flag().is_up());
  ASSERT_EQ(scene.illegal.size(), 10u);
  EXPECT_FALSE(scene.illegal[4]);
  EXPECT_TRUE(scene.illegal[6]);
}

TEST_P(RecoveryTest, TheFourthFailureInTenSecondsStaysAndTheFlagIsUp) {
  restarts_ = {{kFirst, 100, seconds(10), OnFault::kError}};
  standbys_ = {{kFirst, kSpare}};
  const auto fails = [](Cycle c) -> Outcome { return c.count() == 2 ? fault("no current") : ok(); };
  scene.cycle_of_first = scene.cycle_of_spare = fails;
  go(milliseconds(40), {signal(milliseconds(7), Signal::kClear, kSpare)});
  EXPECT_EQ(task(kFirst).profile.takeovers, 1u);
  EXPECT_EQ(task(kSpare).profile.takeovers, 2u);
  EXPECT_EQ(state(kSpare), chimera::State::kError);
  EXPECT_TRUE(set_->flag().is_up());
}

TEST_P(RecoveryTest, ATaskThatWasTurnedOffIsNotReplaced) {
  go(milliseconds(10), {signal(milliseconds(3), Signal::kOff, kFirst)});
  EXPECT_EQ(state(kFirst), chimera::State::kOff);
  EXPECT_EQ(state(kSpare), chimera::State::kOff);
  EXPECT_TRUE(set_->flag().is_up());
}

TEST_P(RecoveryTest, ATakeoverAbortsASwitchThatIsNotCommittedAndLeavesACommittedOne) {
  scene.cycle_of_first = [](Cycle c) -> Outcome {
    if (c.count() == 3) c.request("alone");
    return c.count() == 4 ? fault("no current") : ok();
  };
  scene.on_of_spare = [n = 0](Cycle c) mutable {
    if (n++ == 0) c.spend(microseconds(1500));  // `first` fails while `third` is armed
    return ok();
  };
  go(milliseconds(12));
  // Preemptive, the change comes before the job that fails, which was released before it.
  const bool is_committed = GetParam() == Kind::kPreemptive;
  ASSERT_EQ(runner_->receipts().size(), is_committed ? 1u : 2u);  // the second is of the takeover
  EXPECT_EQ(runner_->receipts()[0].end, is_committed ? SwitchEnd::kDone : SwitchEnd::kAborted);
  EXPECT_EQ(runner_->receipts()[0].why, is_committed ? NoSwitch::kNone : NoSwitch::kDisturbed);
  EXPECT_EQ(state(kFirst), chimera::State::kError);
  EXPECT_EQ(state(kSpare) == chimera::State::kOn, !is_committed);
  EXPECT_EQ(state(kThird) == chimera::State::kOn, is_committed);
  EXPECT_FALSE(was_up());
}

/// `spare` cycles beside `first`.
void make_hot(std::vector<StandbySpec>& standbys) {
  standbys = {{kFirst, kSpare, {}, true}, {kFirst, kThird}};
}

TEST_P(RecoveryTest, AHotStandbyCyclesUnreadAndIsReadFromTheTakeoverOn) {
  make_hot(standbys_);
  fail_first_in(5);
  go(milliseconds(10));
  EXPECT_EQ(state(kSpare), chimera::State::kOn);
  EXPECT_FALSE(task(kSpare).is_warm());
  EXPECT_EQ(scene.ons_of_spare, 1) << "no on at the takeover";
  EXPECT_EQ(task(kSpare).profile.takeovers, 1u);
  EXPECT_FALSE(was_up());
  // The standby began in the gap behind the first cycles and goes on. At 5 ms, when `first` fails, readers already have
  // the value that the standby published at 4 ms.
  EXPECT_EQ(scene.u, (std::vector<double>{1, 2, 3, 4, 5, 103, 104, 105, 106, 107}));
}

TEST_P(RecoveryTest, AHotStandbyThatIsNotReadyIsAskedAgainAPeriodLater) {
  make_hot(standbys_);
  std::vector<std::int64_t> asked;
  scene.on_of_spare = [&asked](Cycle c) -> Outcome {
    asked.push_back(c.now().count);
    return asked.size() < 4 ? not_yet() : ok();
  };
  go(milliseconds(10), {signal(microseconds(1400), Signal::kReinit, kThird)});  // one more edge
  ASSERT_EQ(asked.size(), 4u);
  for (std::size_t i = 1; i < asked.size(); ++i) EXPECT_GE(asked[i] - asked[i - 1], 1'000'000) << i;
  EXPECT_TRUE(task(kSpare).is_warm());
}

TEST_P(RecoveryTest, AHotStandbyIsOffForOtherTasksAndSendsNothing) {
  make_hot(standbys_);
  scene.cycle_of_spare = [](Cycle c) -> Outcome {
    c.request("alone");
    (void)c.signal(Signal::kOff, "reader");
    return ok();
  };
  go(milliseconds(10));
  EXPECT_EQ(task(kSpare).shown_state(), chimera::State::kOff);
  EXPECT_TRUE(task(kSpare).is_warm());
  EXPECT_GE(scene.spare_cycles.size(), 9u);
  EXPECT_EQ(runner_->receipts().size(), 0u);
  EXPECT_TRUE(set_->flag().is_on_set_legal());
  EXPECT_EQ(scene.u.back(), 10) << "no task reads the standby";
  EXPECT_FALSE(was_up());
}

TEST_P(RecoveryTest, AHotStandbyRestsWhileItsPrimaryIsOff) {
  make_hot(standbys_);
  go(milliseconds(12), {signal(milliseconds(3), Signal::kOff, kFirst), signal(milliseconds(8), Signal::kOn, kFirst)});
  EXPECT_EQ(scene.ons_of_spare, 2);
  EXPECT_EQ(scene.offs_of_spare, 1);
  EXPECT_TRUE(task(kSpare).is_warm());
  for (const std::int64_t at : scene.spare_cycles) EXPECT_TRUE(at < 5'000'000 || at >= 8'000'000) << at;
}

TEST_P(RecoveryTest, AHotStandbyThatIsTurnedOffStaysSo) {
  make_hot(standbys_);
  go(milliseconds(12), {signal(milliseconds(4), Signal::kOff, kSpare), signal(milliseconds(8), Signal::kKill, kSpare)});
  EXPECT_EQ(state(kSpare), chimera::State::kNotCreated);
  EXPECT_EQ(scene.ons_of_spare, 1);
  EXPECT_EQ(scene.offs_of_spare, 1);
  EXPECT_EQ(scene.u.back(), 12);
}

TEST_P(RecoveryTest, AHotStandbyThatFailsUnreadMakesPlaceForTheNext) {
  make_hot(standbys_);
  fail_first_in(5);
  scene.cycle_of_spare = [n = 0](Cycle) mutable -> Outcome { return ++n == 3 ? fault("no voltage") : ok(); };
  go(milliseconds(10));
  EXPECT_EQ(state(kSpare), chimera::State::kError);
  EXPECT_FALSE(task(kSpare).is_warm());
  EXPECT_EQ(state(kThird), chimera::State::kOn);
  EXPECT_FALSE(was_up());
}

TEST_P(RecoveryTest, ASwitchToAHotStandbyArmsItAnew) {
  make_hot(standbys_);
  alone_ = {kSpare, kReader};
  scene.cycle_of_first = [](Cycle c) -> Outcome {
    if (c.count() == 4) c.request("alone");
    return ok();
  };
  go(milliseconds(14));
  ASSERT_EQ(runner_->receipts().size(), 1u);
  EXPECT_EQ(runner_->receipts()[0].end, SwitchEnd::kDone);
  EXPECT_EQ(state(kSpare), chimera::State::kOn);
  EXPECT_FALSE(task(kSpare).is_warm());
  EXPECT_EQ(scene.ons_of_spare, 2);
  EXPECT_FALSE(was_up());
}

TEST_P(RecoveryTest, AnInputThatIsTooOldIsNotValid) {
  standbys_ = {};
  stale_ = {{kReader, microseconds(2500)}};
  fail_first_in(3);
  go(milliseconds(8), {signal(microseconds(6500), Signal::kClear, kFirst)});
  // The last publication is from 2 ms. A value that `clear` does not change keeps its age.
  EXPECT_EQ(scene.valid, (std::vector<bool>{true, true, true, true, true, false, false, false}));
}

TEST_P(RecoveryTest, ARestartIsClearThenOn) {
  standbys_ = {};
  restarts_ = {{kFirst, 1, seconds(1), OnFault::kError}};
  scene.cycle_of_first = [n = 0](Cycle) mutable -> Outcome { return ++n == 4 ? fault("no current") : ok(); };
  go(milliseconds(10));
  EXPECT_EQ(state(kFirst), chimera::State::kOn);
  EXPECT_EQ(task(kFirst).profile.restarts, 1u);
  EXPECT_STREQ(task(kFirst).faults.note, "restarted after a fault");
  EXPECT_EQ(scene.ons_of_first, 2);
  EXPECT_EQ(scene.u.size(), 10u);
  EXPECT_FALSE(was_up()) << "no job ran between the fault and the restart";
}

TEST_P(RecoveryTest, MoreFaultsThanRestartsHaveTheReactionBehind) {
  standbys_ = {};
  restarts_ = {{kFirst, 2, seconds(1), OnFault::kFlag}};
  scene.cycle_of_first = [](Cycle c) -> Outcome { return c.count() == 1 ? fault("no current") : ok(); };
  go(milliseconds(10));
  EXPECT_EQ(state(kFirst), chimera::State::kError);
  EXPECT_EQ(task(kFirst).profile.restarts, 2u);
  EXPECT_EQ(scene.ons_of_first, 3);
  EXPECT_TRUE(set_->flag().is_raised());
}

TEST_P(RecoveryTest, AFaultWithinTheTimeOfTheLastRestartCountsOn) {
  standbys_ = {};
  restarts_ = {{kFirst, 2, milliseconds(5), OnFault::kFlag}};
  scene.cycle_of_first = [](Cycle c) -> Outcome { return c.count() == 2 ? fault("no current") : ok(); };
  go(milliseconds(60));
  EXPECT_EQ(state(kFirst), chimera::State::kError) << "a fault every 3 ms: it never ran 5 ms without one";
  EXPECT_EQ(task(kFirst).profile.restarts, 2u);
}

TEST_P(RecoveryTest, RestartsCountAnewAfterTheirTimeWithoutAFault) {
  standbys_ = {};
  restarts_ = {{kFirst, 2, milliseconds(5), OnFault::kFlag}};
  scene.cycle_of_first = [](Cycle c) -> Outcome { return c.count() == 6 ? fault("no current") : ok(); };
  go(milliseconds(60));
  EXPECT_EQ(state(kFirst), chimera::State::kOn) << "a fault every 7 ms";
  EXPECT_GE(task(kFirst).profile.restarts, 7u);
}

TEST_P(RecoveryTest, AnOnThatFailsIsAnotherFault) {
  standbys_ = {};
  restarts_ = {{kFirst, 3, seconds(1), OnFault::kStop}};
  fail_first_in(3);
  scene.on_of_first = [n = 0](Cycle) mutable -> Outcome { return n++ == 0 ? ok() : fault("no voltage"); };
  end_ = RunEnd::kTaskStopped;
  go(milliseconds(10));
  EXPECT_EQ(scene.ons_of_first, 4);
  EXPECT_EQ(task(kFirst).profile.restarts, 3u);
}

TEST_P(RecoveryTest, AClearThatFailsHasTheReactionBehind) {
  standbys_ = {};
  restarts_ = {{kFirst, 3, seconds(1), OnFault::kSwitch}};
  fail_first_in(3);
  scene.clear_of_first = [](Cycle) -> Outcome { return fault("broken"); };
  go(milliseconds(10));
  EXPECT_EQ(state(kFirst), chimera::State::kError);
  EXPECT_EQ(task(kFirst).profile.restarts, 1u);
  ASSERT_EQ(runner_->receipts().size(), 1u);
  EXPECT_EQ(runner_->receipts()[0].end, SwitchEnd::kDone);
  EXPECT_EQ(runner_->receipts()[0].cause, SwitchCause::kFault);
  EXPECT_EQ(state(kThird), chimera::State::kOn);
}

TEST_P(RecoveryTest, ARestartedTaskWithAStandbyIsOnlyCleared) {
  restarts_ = {{kFirst, 1, seconds(1), OnFault::kError}};
  fail_first_in(3);
  go(milliseconds(10));
  EXPECT_EQ(state(kFirst), chimera::State::kOff);
  EXPECT_EQ(state(kSpare), chimera::State::kOn);
  EXPECT_EQ(scene.ons_of_first, 1);
  EXPECT_STREQ(task(kFirst).faults.note, "is cleared; it stays OFF beside its standby");
}

}  // namespace
}  // namespace chimera::toy
