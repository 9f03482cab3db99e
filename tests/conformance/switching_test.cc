// SPDX-License-Identifier: Apache-2.0
// A switch of configurations on every executor of one context: no cycle is lost, tasks that stay are not disturbed, and
// a switch that fails leaves nothing behind.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

/// Release of each job in ns, and the value that it published.
using Log = std::vector<std::tuple<std::int64_t, double>>;

/// Actions of the components of a run, and the values that they read. One run at a time.
struct Scene {
  Log plant, beacon, u;
  std::vector<std::string> story;  // "on two", "off one" in the order of the calls
  double on_of_two = 0;            // added to what `on` takes over
  double first_cycle_of_two = 0;   // added to the first cycle's law
  bool on_of_two_fails = false, two_sends = false;
  Nanoseconds on_takes = microseconds(30);
  Nanoseconds long_beacon_at = kNever, long_beacon;  // from this instant one cycle takes this time
};
Scene scene;

void put(Log& log, const Cycle& c, double value) { log.emplace_back(c.now().count, value); }

struct Plant {
  In<double> u{"u", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle c) {
    *y = *y + 0.1 * (*u - *y);
    put(scene.plant, c, *y);
    put(scene.u, c, *u);
  }
};

struct Beacon {  // is connected to no task
  Out<double> b{"b", "1", initial = 0.0};
  void cycle(Cycle c) {
    if (c.now() >= scene.long_beacon_at) c.spend(std::exchange(scene.long_beacon, {}));
    *b = *b * 0.9 + static_cast<double>(c.now().count % 997);
    put(scene.beacon, c, *b);
  }
  void reinit() { scene.story.emplace_back("reinit beacon"); }
};

double law(double y) { return 0.7 * (1 - y); }

struct One {
  In<double> y{"y", "1"};
  Out<double> u{"u", "1", initial = 0.0};
  void on(Cycle) { scene.story.emplace_back("on one"); }
  void cycle(Cycle) { *u = law(*y); }
  void off(Cycle c) {
    scene.story.emplace_back("off one");
    c.spend(microseconds(20));
    *u = 1e6;  // no task may read this
  }
};

struct Observer {
  In<double> y{"y", "1"};
  Out<double> z{"z", "1", initial = 0.0};
  void on(Cycle) {
    scene.story.emplace_back("on observer");
    *z = *y;
  }
  void cycle(Cycle) { *z = *y; }
  void off(Cycle) { scene.story.emplace_back("off observer"); }
};

struct Two {
  In<double> z{"z", "1"};
  Out<double> u{"u", "1", initial = 0.0};
  Outcome on(Cycle c) {
    scene.story.emplace_back("on two");
    c.spend(scene.on_takes);
    first = true;
    if (scene.two_sends) c.signal(Signal::kReinit, "beacon");
    if (scene.on_of_two_fails) return fault("no current");
    *u = *u + scene.on_of_two;
    return ok();
  }
  void cycle(Cycle) {
    *u = law(*z) + (first ? scene.first_cycle_of_two : 0);
    first = false;
  }
  void off(Cycle) { scene.story.emplace_back("off two"); }
  bool first = false;
};

constexpr TaskId kPlant{0u}, kBeacon{1u}, kOne{2u}, kObserver{3u}, kTwo{4u};
constexpr std::uint32_t kDirect = 0, kObserved = 1, kBare = 2;

class Switches : public ::testing::TestWithParam<Kind> {
 protected:
  void SetUp() override { scene = {}; }
  void build() {
    set_.reset();
    app_ = std::make_unique<testing::TestApplication>();
    app_->add("plant", testing::component<Plant>("plant")).budget = microseconds(100);
    app_->add("beacon", testing::component<Beacon>("beacon")).budget = microseconds(50);
    app_->add("one", testing::component<One>("one")).budget = microseconds(100);
    app_->add("observer", testing::component<Observer>("observer")).budget = microseconds(50);
    app_->add("two", testing::component<Two>("two")).budget = microseconds(50);
    app_->tasks[kOne.index].deadline = deadline_of_one_;
    if (limit_ > 0) app_->port(kTwo.index, 1).max_step = std::as_bytes(std::span(&limit_, 1));
    app_->make({kPlant, kBeacon, kOne}, false);
    app_->spec.sets = sets_;
    set_ = *HeapTaskSet::create(app_->spec, app_->components);
  }
  /// Runs it all with `acts` and answers the receipts.
  std::span<const SwitchReceipt> go(Nanoseconds duration, const std::vector<ScriptAct>& acts) {
    acts_ = acts;
    runner_.reset();
    build();
    runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
    EXPECT_TRUE(runner_->start());
    EXPECT_EQ(runner_->run(duration), RunEnd::kTime);
    return runner_->receipts();
  }
  static ScriptAct to(std::uint32_t set, Nanoseconds at) {
    ScriptAct act;
    act.at = at;
    act.kind = ScriptAct::Kind::kSwitch;
    act.set = set;
    return act;
  }
  /// Methods wait for an idle processor.
  bool needs_gaps() const { return GetParam() != Kind::kPreemptive; }
  chimera::State state(TaskId task) const { return set_->tasks()[task.index].state; }
  const TaskPart& part(const SwitchReceipt& receipt, TaskId task) const {
    return *std::ranges::find(receipt.tasks, task, &TaskPart::task);
  }
  /// Groups of the tasks of the first set: header and values of the latest publication.
  std::vector<std::byte> groups() const {
    std::vector<std::byte> bytes;
    for (const TaskId id : direct_) {
      const GroupWriter& group = set_->tasks()[id.index].group;
      const auto* const begin = reinterpret_cast<const std::byte*>(group.published());
      bytes.insert(bytes.end(), begin, begin + sizeof(chimera_slot) + group.payload_bytes());
    }
    return bytes;
  }
  std::uint64_t losses() const {
    std::uint64_t n = 0;
    for (const Task& task : set_->tasks()) n += task.profile.dropped + task.profile.missed + task.profile.aborted;
    return n;
  }

  std::vector<TaskId> direct_{kPlant, kBeacon, kOne}, observed_{kPlant, kBeacon, kObserver, kTwo};
  std::vector<TaskId> bare_{kPlant, kBeacon};
  NamedSet sets_[3] = {{"direct", direct_}, {"observed", observed_}, {"bare", bare_}};
  double limit_ = 0;
  Nanoseconds deadline_of_one_ = milliseconds(1);
  std::vector<ScriptAct> acts_;
  std::unique_ptr<testing::TestApplication> app_;
  std::unique_ptr<HeapTaskSet> set_;
  std::unique_ptr<Runner> runner_;
};

INSTANTIATE_TEST_SUITE_P(All, Switches, ::testing::Values(Kind::kExecutiveOnTwin, Kind::kVirtual, Kind::kPreemptive),
                         [](const auto& one) { return kind_name(one.param); });

TEST_P(Switches, ArmBesideThePredecessorCommitAtOneInstantAndTurnOffBehindIt) {
  const auto receipts = go(milliseconds(20), {to(kObserved, microseconds(5600))});
  ASSERT_EQ(receipts.size(), 1u);
  const SwitchReceipt& receipt = receipts[0];
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(receipt.number, 1u);
  EXPECT_EQ(receipt.before, kDirect);
  EXPECT_EQ(receipt.after, kObserved);
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on one", "on observer", "on two", "off one"}));
  EXPECT_EQ(part(receipt, kTwo).on, microseconds(30));
  EXPECT_EQ(part(receipt, kOne).off, microseconds(20));
  EXPECT_EQ(receipt.at, receipt.armed);
  EXPECT_EQ(receipt.at - receipt.asked, microseconds(30));
  EXPECT_EQ(state(kOne), chimera::State::kOff);
  EXPECT_EQ(state(kTwo), chimera::State::kOn);
  EXPECT_FALSE(set_->flag().is_up());
  ASSERT_EQ(receipt.variables.size(), 2u);
  EXPECT_EQ(losses(), 0u);
  EXPECT_EQ(set_->tasks()[kTwo.index].profile.cycles, 14u);  // released at 6 to 19 ms
  EXPECT_EQ(set_->tasks()[kOne.index].profile.cycles, 6u);   // at 0 to 5 ms
}

// The laws of both sets compute equal values: tasks that stay must publish equal bits with and without the switches.
TEST_P(Switches, TenThousandAtRandomInstantsLoseNoCycleOfTasksThatStay) {
  std::vector<ScriptAct> acts;
  std::mt19937 random(7);
  Nanoseconds at = milliseconds(10);
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    acts.push_back(to(i % 2 == 0 ? kObserved : kDirect, at));
    at += microseconds(3000) + Nanoseconds{static_cast<std::int64_t>(random() % 2000000)};
  }
  const Nanoseconds end = at + milliseconds(10);
  go(end, {});
  const Log plant = scene.plant, beacon = scene.beacon, u = scene.u;
  scene = {};
  const auto receipts = go(end, acts);
  ASSERT_EQ(receipts.size(), acts.size());
  std::uint32_t n = 0;
  for (const SwitchReceipt& receipt : receipts) {
    ASSERT_EQ(receipt.number, ++n);
    ASSERT_EQ(receipt.end, SwitchEnd::kDone) << n << " for " << static_cast<int>(receipt.why);
    for (const TaskPart& each : receipt.tasks) ASSERT_EQ(each.lost, 0u) << n;
    ASSERT_LE(receipt.at - receipt.asked, milliseconds(1)) << n;
  }
  EXPECT_EQ(losses(), 0u);
  EXPECT_TRUE(plant == scene.plant);
  EXPECT_TRUE(beacon == scene.beacon);
  EXPECT_TRUE(u == scene.u);  // values that `on` and `off` write are never read
  const auto& tasks = set_->tasks();
  const std::uint64_t releases = tasks[kPlant.index].profile.cycles;
  EXPECT_EQ(tasks[kOne.index].profile.cycles + tasks[kTwo.index].profile.cycles, releases);
  EXPECT_EQ(tasks[kObserver.index].profile.cycles, tasks[kTwo.index].profile.cycles);
}

TEST_P(Switches, AnOnThatFailsUndoesEverything) {
  go(milliseconds(20), {});
  const Log plant = scene.plant, beacon = scene.beacon, u = scene.u;
  const std::vector<std::byte> before = groups();
  scene = {};
  scene.on_of_two_fails = true;
  const auto receipts = go(milliseconds(20), {to(kObserved, microseconds(5600))});
  ASSERT_EQ(receipts.size(), 1u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kOnFailed);
  EXPECT_EQ(receipts[0].task, kTwo);
  EXPECT_EQ(receipts[0].said.view(), "no current");
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on one", "on observer", "on two", "off observer"}));
  EXPECT_TRUE(plant == scene.plant && beacon == scene.beacon && u == scene.u);
  EXPECT_TRUE(before == groups());
  EXPECT_EQ(state(kOne), chimera::State::kOn);
  EXPECT_EQ(state(kObserver), chimera::State::kOff);
  EXPECT_FALSE(set_->tasks()[kObserver.index].owes_off);
  EXPECT_EQ(losses(), 0u);
}

TEST_P(Switches, ASignalFromOnIsSentAtTheChangeOnly) {
  scene.two_sends = true;
  scene.on_takes = microseconds(600);
  go(milliseconds(20), {to(kObserved, microseconds(5600))});
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on one", "on observer", "on two", "reinit beacon", "off one"}));
  scene.story.clear();
  scene.on_of_two_fails = true;
  go(milliseconds(20), {to(kObserved, microseconds(5600))});
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on one", "on observer", "on two", "off observer"}));
}

TEST_P(Switches, AStepOfOnBeyondTheLimitUndoesEverything) {
  limit_ = 0.5;
  scene.on_of_two = 0.6;
  const auto receipts = go(milliseconds(20), {to(kObserved, microseconds(5600))});
  EXPECT_EQ(receipts[0].why, NoSwitch::kStepTooLarge);
  EXPECT_EQ(receipts[0].task, kTwo);
  EXPECT_EQ(scene.story,
            (std::vector<std::string>{"on one", "on observer", "on two", "off two", "off observer"}));
  EXPECT_EQ(state(kOne), chimera::State::kOn);
  EXPECT_EQ(state(kTwo), chimera::State::kOff);
}

TEST_P(Switches, ReportsAStepOfTheFirstCycleBeyondTheLimit) {
  limit_ = 0.5;
  scene.first_cycle_of_two = 0.6;
  const auto receipts = go(milliseconds(20), {to(kObserved, microseconds(5600))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone);
  const auto u = std::ranges::find_if(receipts[0].variables, [](const VariablePart& part) {
    return part.handover.from.task == kOne;
  });
  ASSERT_NE(u, receipts[0].variables.end());
  EXPECT_EQ(u->step_of_on.size, 0);
  EXPECT_FALSE(u->step_of_on.is_beyond);
  EXPECT_TRUE(u->step_of_cycle.is_beyond);
  EXPECT_NEAR(u->step_of_cycle.size, 0.6, 0.1);
  EXPECT_EQ(u->step_of_cycle.limit, 0.5);
}

// One cycle of the beacon takes 1.4 ms within the switch: other tasks start late, and the receipt has their delay.
TEST_P(Switches, TheReceiptHasTheLongestDelayOfAStart) {
  scene.long_beacon_at = microseconds(5700);
  scene.long_beacon = microseconds(1400);
  const auto receipts = go(milliseconds(40), {to(kObserved, microseconds(5600))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone) << static_cast<int>(receipts[0].why);
  Nanoseconds longest, before;
  for (const TaskPart& part : receipts[0].tasks) {
    longest = std::max(longest, part.delay);
    before = std::max(before, part.delay_before);
  }
  EXPECT_GE(longest, microseconds(300));
  EXPECT_LE(before, microseconds(200));
}

TEST_P(Switches, OneSwitchAtATimeAndNoneToTheSetInForce) {
  scene.on_takes = microseconds(600);
  const auto receipts = go(milliseconds(20), {to(kDirect, milliseconds(2)), to(kObserved, microseconds(5600)),
                                              to(kDirect, microseconds(5610)), to(kDirect, milliseconds(9))});
  ASSERT_EQ(receipts.size(), 4u);
  EXPECT_EQ(receipts[0].end, SwitchEnd::kNothingToDo);
  EXPECT_EQ(receipts[1].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[2].end, SwitchEnd::kRefused);
  EXPECT_EQ(receipts[2].why, NoSwitch::kUnderWay);
  EXPECT_EQ(receipts[3].end, SwitchEnd::kDone);
  EXPECT_EQ(receipts[3].number, 3u);
  EXPECT_EQ(state(kOne), chimera::State::kOn);
}

// `on` of two takes longer than expected: jobs that were released during it publish the values of a run without it.
TEST_P(Switches, AnOnThatOverrunsItsGapDoesNotChangeReleasedJobs) {
  go(milliseconds(20), {});
  const Log u = scene.u;
  scene = {};
  scene.on_takes = microseconds(600);
  scene.on_of_two = 0.5;
  const auto receipts = go(milliseconds(20), {to(kObserved, microseconds(5600))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone);
  EXPECT_TRUE(std::equal(u.begin(), u.begin() + 7, scene.u.begin()));  // released at 0 to 6 ms: the predecessor's
  EXPECT_NE(u[7], scene.u[7]);                                         // value of `on`
  EXPECT_EQ(receipts[0].armed, milliseconds(6) + microseconds(200));
  // Plant, beacon and one were released at 6 ms: the change comes after the first of them, and waits for none.
  EXPECT_GE(receipts[0].at, receipts[0].armed);
  EXPECT_LE(receipts[0].at, receipts[0].armed + microseconds(100));
  EXPECT_EQ(set_->tasks()[kOne.index].profile.cycles, 7u);
  EXPECT_EQ(set_->tasks()[kTwo.index].profile.cycles, 13u);
  EXPECT_EQ(losses(), 0u);
}

// Asked for at 6.2 ms, while a job of 2.5 ms may hold the processor: a task that leaves has its cycle of the last
// release before the change, also when that release is only noticed then.
TEST_P(Switches, AReleaseBeforeTheChangeIsMadeBeforeTheChange) {
  scene.long_beacon_at = milliseconds(5);
  scene.long_beacon = microseconds(2500);
  deadline_of_one_ = microseconds(900);
  const auto receipts = go(milliseconds(20), {to(kBare, microseconds(6200))});
  ASSERT_EQ(receipts[0].end, SwitchEnd::kDone);
  // With preemption beacon is late and goes on: its release at 6 ms waits until the release at 7 ms replaces it.
  EXPECT_EQ(set_->tasks()[kOne.index].profile.cycles, GetParam() == Kind::kPreemptive ? 6u : 7u);
  EXPECT_EQ(state(kOne), chimera::State::kOff);
}

TEST_P(Switches, ASignalToAMemberAbortsTheSwitch) {
  scene.on_takes = microseconds(600);
  const ScriptAct kill{milliseconds(6), ScriptAct::Kind::kSignal, Signal::kKill, kObserver};
  const auto receipts = go(milliseconds(20), {to(kObserved, microseconds(5600)), kill});
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kDisturbed);
  EXPECT_EQ(receipts[0].task, kObserver);
  EXPECT_EQ(state(kObserver), chimera::State::kNotCreated);
  EXPECT_EQ(state(kTwo), chimera::State::kOff);
  EXPECT_EQ(state(kOne), chimera::State::kOn);
  EXPECT_EQ(std::ranges::count(scene.story, "off observer"), 1);
  EXPECT_EQ(std::ranges::count(scene.story, "off two"), 1);
}

TEST_P(Switches, OffOfAnArmedTaskTakesItsArmingBack) {
  scene.on_takes = microseconds(600);
  const ScriptAct off{milliseconds(6), ScriptAct::Kind::kSignal, Signal::kOff, kTwo};
  const auto receipts = go(milliseconds(20), {to(kObserved, microseconds(5600)), off});
  EXPECT_EQ(receipts[0].why, NoSwitch::kDisturbed);
  EXPECT_EQ(std::ranges::count(scene.story, "off two"), 1);
  EXPECT_EQ(state(kOne), chimera::State::kOn);
}

TEST_P(Switches, ATaskInErrorIsNamed) {
  scene.on_of_two_fails = true;
  const auto receipts = go(milliseconds(20), {to(kObserved, milliseconds(4)), to(kObserved, milliseconds(9))});
  EXPECT_EQ(receipts[0].why, NoSwitch::kOnFailed);
  EXPECT_EQ(state(kTwo), chimera::State::kError);
  EXPECT_EQ(receipts[1].end, SwitchEnd::kRefused);
  EXPECT_EQ(receipts[1].why, NoSwitch::kInError);
  EXPECT_EQ(receipts[1].task, kTwo);
}

TEST_P(Switches, TheEndOfTheRunTakesAnUnfinishedOneBack) {
  go(microseconds(5650), {to(kObserved, microseconds(5640))});
  runner_->shut_down();
  EXPECT_EQ(runner_->receipts()[0].end == SwitchEnd::kDone, std::ranges::count(scene.story, "off one") == 1 &&
                                                                state(kOne) == chimera::State::kNotCreated &&
                                                                runner_->receipts()[0].at != kNever);
  EXPECT_EQ(std::ranges::count(scene.story, "on observer"), std::ranges::count(scene.story, "off observer"));
  EXPECT_EQ(std::ranges::count(scene.story, "on two"), std::ranges::count(scene.story, "off two"));
}

TEST_P(Switches, ARaisedFlagUndoesAnUncommittedSwitch) {
  scene.on_takes = microseconds(600);
  const ScriptAct up{milliseconds(6), ScriptAct::Kind::kRaiseFlag, Signal::kOn, TaskId()};
  const auto receipts = go(milliseconds(20), {to(kObserved, microseconds(5600)), up});
  EXPECT_EQ(receipts[0].end, SwitchEnd::kAborted);
  EXPECT_EQ(receipts[0].why, NoSwitch::kFlagRaised);
}

// A switch that would break a guarantee with both sets ON is slow: leaving tasks are OFF before arriving ones are ON.
TEST_P(Switches, ASwitchThatRisksADeadlineIsSlow) {
  build();
  acts_ = {to(kObserved, milliseconds(5))};
  app_->tasks[kObserver.index].budget = milliseconds(2);
  runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
  EXPECT_TRUE(runner_->start());
  EXPECT_EQ(runner_->run(milliseconds(60)), RunEnd::kTime);
  const SwitchReceipt& receipt = runner_->receipts()[0];
  ASSERT_EQ(receipt.end, SwitchEnd::kDone) << static_cast<int>(receipt.why);
  EXPECT_EQ(receipt.way.slow, kSlowForDeadlines | (needs_gaps() ? kSlowForGap : 0));
  EXPECT_TRUE(receipt.way.deadline.task.is_valid());
  EXPECT_EQ(receipt.before, kDirect);
  EXPECT_GT(receipt.flag, Nanoseconds{});
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on one", "off one", "on observer", "on two"}));
}

// Two acts of one instant: the second one finds a plan that is announced and not taken up.
TEST_P(Switches, RefusesSecondSwitchAtSameInstant) {
  build();
  for (const std::uint32_t second : {kDirect, kObserved}) {
    build();
    acts_ = {to(kObserved, milliseconds(5)), to(second, milliseconds(5))};
    runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
    EXPECT_TRUE(runner_->start());
    EXPECT_EQ(runner_->run(milliseconds(30)), RunEnd::kTime);
    ASSERT_EQ(runner_->receipts().size(), 2u);
    EXPECT_EQ(runner_->receipts()[0].end, SwitchEnd::kDone);
    EXPECT_EQ(runner_->receipts()[0].tasks.size(), 5u);
    EXPECT_EQ(runner_->receipts()[1].end, SwitchEnd::kRefused);
    EXPECT_EQ(runner_->receipts()[1].why, NoSwitch::kUnderWay);
  }
}

// `on` is assumed to need the budget. If the budget is above the shortest period, the switch is slow at once.
TEST_P(Switches, AnOnThatFitsNoGapMakesTheSwitchSlowAtOnce) {
  build();
  acts_ = {to(kObserved, milliseconds(5))};
  app_->tasks[kObserver.index].budget = milliseconds(2);
  for (TaskSpec& task : app_->tasks) task.on_miss = OnMiss::kAbort;  // no deadline is judged
  runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
  EXPECT_TRUE(runner_->start());
  EXPECT_EQ(runner_->run(milliseconds(30)), RunEnd::kTime);
  const SwitchReceipt& receipt = runner_->receipts()[0];
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  EXPECT_EQ(receipt.way.slow, needs_gaps() ? kSlowForGap : 0);
  EXPECT_EQ(receipt.way.gapless, needs_gaps() ? kObserver : TaskId());
  EXPECT_EQ(receipt.way.needed, needs_gaps() ? milliseconds(2) : Nanoseconds{});
  EXPECT_EQ(receipt.tries, 1u);
  EXPECT_LE(receipt.at - receipt.asked, milliseconds(3));
}

// Held up for 8 ms, it needs 4.8 ms after the next call, and 0.6 ms after the fourth.
TEST_P(Switches, AnOnThatWasHeldUpOnceIsNotSlowForEver) {
  build();
  for (int n = 0; n < 5; ++n)
    acts_.insert(acts_.end(), {to(kObserved, milliseconds(5 + 20 * n)), to(kDirect, milliseconds(15 + 20 * n))});
  for (TaskSpec& task : app_->tasks) task.on_miss = OnMiss::kAbort;  // no deadline is judged
  runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
  set_->tasks()[kObserver.index].profile.add_call(Method::kOn, milliseconds(8));
  EXPECT_TRUE(runner_->start());
  EXPECT_EQ(runner_->run(milliseconds(110)), RunEnd::kTime);
  ASSERT_EQ(runner_->receipts().size(), 10u);
  EXPECT_EQ(runner_->receipts()[0].way.slow, needs_gaps() ? kSlowForGap : 0);
  EXPECT_EQ(runner_->receipts()[0].way.needed, needs_gaps() ? microseconds(9600) : Nanoseconds{});
  EXPECT_EQ(runner_->receipts()[8].way.slow, 0u);
  for (const SwitchReceipt& receipt : runner_->receipts()) EXPECT_EQ(receipt.end, SwitchEnd::kDone);
}

// Without a gap that `on` fits in, the switch becomes slow after 10 s.
TEST_P(Switches, WithoutAGapTheSwitchIsSlowAfterTenSeconds) {
  build();
  acts_ = {to(kObserved, milliseconds(5))};
  app_->tasks[kObserver.index].budget = microseconds(600);
  app_->tasks[kBeacon.index].offset = microseconds(500);
  for (TaskSpec& task : app_->tasks) task.on_miss = OnMiss::kAbort;  // no deadline is judged
  runner_ = std::make_unique<Runner>(*set_, GetParam(), Policy::kEdf, acts_);
  EXPECT_TRUE(runner_->start());
  EXPECT_EQ(runner_->run(seconds(11)), RunEnd::kTime);
  const SwitchReceipt& receipt = runner_->receipts()[0];
  EXPECT_EQ(receipt.end, SwitchEnd::kDone);
  if (!needs_gaps()) {
    EXPECT_EQ(receipt.way.slow, 0);
    EXPECT_LE(receipt.at - receipt.asked, milliseconds(3));
    return;
  }
  EXPECT_EQ(receipt.way.slow, kSlowForGap);
  EXPECT_EQ(receipt.tries, 2u);
  EXPECT_GE(receipt.at - receipt.asked, seconds(10));
  EXPECT_LE(receipt.flag, milliseconds(5));
  EXPECT_GT(receipt.flag, Nanoseconds{});
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on one", "off one", "on observer", "on two"}));
  EXPECT_EQ(runner_->receipts().size(), 1u);
  EXPECT_FALSE(set_->flag().is_up());
}

}  // namespace
}  // namespace chimera::toy
