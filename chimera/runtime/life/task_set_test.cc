// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/hosted/refusal_text.h"
#include "chimera/runtime/hosted/variables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

using testing::component;
using testing::TestApplication;

struct Counter {  // counts up from 1; throws at 13, returns a fault at 14, publishes NaN at 15
  Out<double> n{"n", "1", initial = 0.0, safety, range(-100, 100)};
  InConst<double> step{"step", "1", initial = 1.0};
  void on(Cycle) {
    sum_ = *n;
    inherited_ = n.inherited();
    is_handed_over_ = n.is_handed_over();
    is_outdated_ = n.is_outdated();
  }
  Outcome cycle(Cycle) {
    sum_ += *step;
    if (sum_ == 13) throw std::runtime_error("thirteen");
    if (sum_ == 14) return fault("fourteen", 14);
    *n = sum_ == 15 ? std::nan("") : sum_;
    return ok();
  }
  bool error(Cycle) { return recovers_; }
  double sum_ = 0;
  bool recovers_ = true;
  Nanoseconds inherited_;
  bool is_handed_over_ = false, is_outdated_ = false;
};

struct Reader {
  In<double> n{"n", "1"};
  Out<double> seen{"seen", "1"};
  void cycle(Cycle) { *seen = *n; }
};

struct Arm {  // produces the constant that fixes extents
  OutConst<std::int32_t> ndof{"ndof", "1"};
  Out<double[]> q{"q", "rad", "[ndof<=10]"};
  void init(Cycle) { *ndof = wanted_; }
  void reinit(Cycle) { *ndof = wanted_; }
  void cycle(Cycle) { for (std::size_t i = 0; i < q.size(); ++i) q[i] = static_cast<double>(i); }
  std::int32_t wanted_ = 3;
};

struct User {
  InConst<std::int32_t> ndof{"ndof", "1"};
  In<double[]> q{"q", "rad", "[ndof<=10]"};
  Out<std::int32_t> inits{"inits", "1", initial = 0};
  void init(Cycle) { ++inits_; }
  void reinit(Cycle) { ++inits_; }
  void cycle(Cycle) { *inits = inits_ * 100 + static_cast<std::int32_t>(q.size()); }
  std::int32_t inits_ = 0;
};

struct Jammed {  // its `off` always fails
  Out<double> n{"n", "1", initial = 0.0};
  void cycle(Cycle) {}
  void off(Cycle) { throw std::runtime_error("jammed"); }
};

VariableView view(TaskSet& set, const char* variable) {
  return set.sources().view(VariableId(Variables(set.spec()).find(variable)));
}

double number(TaskSet& set, const char* variable) {
  double value;
  std::memcpy(&value, view(set, variable).value, sizeof value);
  return value;
}

State run_cycle(TaskSet& set, std::size_t task, Nanoseconds at) {
  const CycleTime time{at, at + milliseconds(1), 0, set.flag().is_up()};
  Task& t = set.tasks()[task];
  const BodyEnd body = begin_cycle(t, time);
  const State state = end_cycle(t, body, time, at + microseconds(10), true, nullptr);
  set.sent().deliver(t);
  return state;
}

std::unique_ptr<HeapTaskSet> make(TestApplication& app) {
  auto set = HeapTaskSet::create(app.spec, app.components);
  EXPECT_TRUE(set) << set.error().message.view();
  return *std::move(set);
}

struct CounterAndReader : ::testing::Test {
  CounterAndReader() {
    app.add("counter", component<Counter>("counter"));
    app.add("reader", component<Reader>("reader"));
    app.make();
    set = make(app);
  }
  TestApplication app;
  std::unique_ptr<HeapTaskSet> set;
};

TEST_F(CounterAndReader, SpawnsTurnsOnAndMovesValues) {
  ASSERT_TRUE(set->life().start({}));
  EXPECT_EQ(set->tasks()[0].state, State::kOn);
  EXPECT_FALSE(view(*set, "seen").is_valid);
  EXPECT_TRUE(std::isnan(number(*set, "seen")));  // never written
  run_cycle(*set, 0, milliseconds(1));
  run_cycle(*set, 1, milliseconds(1));
  EXPECT_EQ(number(*set, "seen"), 1);
  EXPECT_TRUE(view(*set, "seen").is_valid);
}

TEST_F(CounterAndReader, AFailingCyclePublishesNothingAndSaysWhy) {
  ASSERT_TRUE(set->life().start({}));
  for (int i = 1; i <= 12; ++i) run_cycle(*set, 0, milliseconds(i));
  EXPECT_EQ(number(*set, "n"), 12);
  EXPECT_EQ(run_cycle(*set, 0, milliseconds(13)), State::kOn);  // error() recovers
  EXPECT_STREQ(set->tasks()[0].faults.last.text, "thirteen");
  EXPECT_EQ(number(*set, "n"), 12);
  run_cycle(*set, 0, milliseconds(14));
  EXPECT_STREQ(set->tasks()[0].faults.last.text, "fourteen");
  EXPECT_EQ(set->tasks()[0].faults.last.code, 14);
  run_cycle(*set, 0, milliseconds(15));
  EXPECT_STREQ(set->tasks()[0].faults.last.text, "safety port n: element 0 is NaN; the last good value stands");
  EXPECT_EQ(set->tasks()[0].profile.rejected, 1u);
  EXPECT_EQ(number(*set, "n"), 12);
  run_cycle(*set, 0, milliseconds(16));
  EXPECT_EQ(number(*set, "n"), 16);
  EXPECT_EQ(set->tasks()[0].faults.count, 3u);
}

TEST_F(CounterAndReader, AFaultThatIsNotRecoveredEndsInErrorAndClearLeadsToOff) {
  ASSERT_TRUE(set->life().start({}));
  static_cast<Counter*>(set->tasks()[0].instance)->recovers_ = false;
  static_cast<Counter*>(set->tasks()[0].instance)->sum_ = 12;
  EXPECT_EQ(run_cycle(*set, 0, milliseconds(1)), State::kError);
  set->on_set_changed();
  EXPECT_TRUE(set->flag().is_up());  // the reader has no producer that is ON
  EXPECT_TRUE(set->life().signal(TaskId{std::size_t{0}}, Signal::kClear, {}).is_accepted);
  EXPECT_EQ(set->tasks()[0].state, State::kOff);
  EXPECT_TRUE(set->life().signal(TaskId{std::size_t{0}}, Signal::kOn, {}).is_accepted);
  EXPECT_FALSE(set->flag().is_up());
}

TEST_F(CounterAndReader, ARespawnedProducerTakesOverTheLastValue) {
  ASSERT_TRUE(set->life().start({}));
  for (int i = 1; i <= 5; ++i) run_cycle(*set, 0, milliseconds(i));
  const TaskId counter{std::size_t{0}};
  set->life().signal(counter, Signal::kKill, {});
  EXPECT_EQ(set->tasks()[0].state, State::kNotCreated);
  EXPECT_EQ(number(*set, "n"), 5);
  ASSERT_TRUE(set->life().signal(counter, Signal::kSpawn, {}).is_accepted);
  EXPECT_EQ(number(*set, "n"), 5) << "consumers stay with the old incarnation until the new one is ON";
  ASSERT_TRUE(set->life().signal(counter, Signal::kOn, {}).is_accepted);
  EXPECT_EQ(number(*set, "n"), 5) << "bumpless";
  run_cycle(*set, 0, milliseconds(6));
  EXPECT_EQ(number(*set, "n"), 6);
}

TEST_F(CounterAndReader, AnInitialValueIsNotInherited) {
  ASSERT_TRUE(set->life().start({}));
  const auto counter = [&] { return static_cast<Counter*>(set->tasks()[0].instance); };
  EXPECT_EQ(counter()->inherited_, kNever) << "an initial value is no publication";
  EXPECT_FALSE(counter()->is_handed_over_);
  EXPECT_FALSE(counter()->is_outdated_);
  run_cycle(*set, 0, milliseconds(1));
  set->life().signal(TaskId{std::size_t{0}}, Signal::kKill, milliseconds(2));
  ASSERT_TRUE(set->life().signal(TaskId{std::size_t{0}}, Signal::kSpawn, milliseconds(3)).is_accepted);
  EXPECT_EQ(counter()->n.inherited(), kNever) << "before on";
  ASSERT_TRUE(set->life().signal(TaskId{std::size_t{0}}, Signal::kOn, milliseconds(7)).is_accepted);
  EXPECT_EQ(counter()->inherited_, milliseconds(5)) << "since off, which kill began with";
  set->life().signal(TaskId{std::size_t{0}}, Signal::kOff, milliseconds(8));
  ASSERT_TRUE(set->life().signal(TaskId{std::size_t{0}}, Signal::kOn, milliseconds(4)).is_accepted);
  EXPECT_EQ(counter()->inherited_, Nanoseconds{}) << "a clock that was read before";
}

TEST_F(CounterAndReader, ClearDoesNotRenewTheAgeOfAValue) {
  ASSERT_TRUE(set->life().start({}));
  run_cycle(*set, 0, milliseconds(1));
  static_cast<Counter*>(set->tasks()[0].instance)->recovers_ = false;
  static_cast<Counter*>(set->tasks()[0].instance)->sum_ = 12;
  EXPECT_EQ(run_cycle(*set, 0, milliseconds(2)), State::kError);
  const TaskId counter{std::size_t{0}};
  ASSERT_TRUE(set->life().signal(counter, Signal::kClear, milliseconds(500)).is_accepted);
  EXPECT_EQ(number(*set, "n"), 1);
  ASSERT_TRUE(set->life().signal(counter, Signal::kOn, milliseconds(501)).is_accepted);
  EXPECT_EQ(static_cast<Counter*>(set->tasks()[0].instance)->inherited_, milliseconds(500) - microseconds(10));
}

TEST(TaskSet, ASuccessorKnowsTheAgeAndFreshnessByThePeriodOfItsPredecessor) {
  struct Case {
    Nanoseconds period, age;
    bool is_aperiodic, is_fresh;
  };
  for (const Case& one : {Case{milliseconds(1), milliseconds(10), false, true},
                          Case{milliseconds(1), milliseconds(10) + Nanoseconds{1}, false, false},
                          Case{milliseconds(20), milliseconds(40), false, true},
                          Case{milliseconds(20), milliseconds(40) + Nanoseconds{1}, false, false},
                          Case{milliseconds(20), milliseconds(11), true, false}}) {
    TestApplication app;
    app.add("a", component<Counter>("counter"), one.period).aperiodic = one.is_aperiodic;
    app.add("b", component<Counter>("counter"));
    app.make({TaskId{std::size_t{0}}}, false);
    auto set = make(app);
    ASSERT_TRUE(set->life().start({}));
    const TaskId a{std::size_t{0}}, b{std::size_t{1}};
    run_cycle(*set, 0, milliseconds(1));
    set->life().signal(a, Signal::kOff, milliseconds(2));
    ASSERT_TRUE(set->life().signal(b, Signal::kOn, milliseconds(2) + one.age).is_accepted);
    const auto& successor = *static_cast<Counter*>(set->tasks()[1].instance);
    EXPECT_EQ(successor.sum_, 1);
    EXPECT_EQ(successor.inherited_, one.age);
    EXPECT_EQ(successor.is_handed_over_, one.is_fresh) << one.age.count;
    EXPECT_EQ(successor.is_outdated_, !one.is_fresh);
  }
}

/// The arm says by a constant how many joints both have, up to ten.
void add_arm_and_user(TestApplication& app) {
  app.add("arm", component<Arm>("arm"));
  app.add("user", component<User>("user"));
  app.extend(0, 1, 10, "ndof");
  app.extend(1, 1, 10, "ndof");
}

TEST(TaskSet, TwoProducersOfOneVariableCannotBothBeOn) {
  TestApplication app;
  app.add("a", component<Counter>("counter"));
  app.add("b", component<Counter>("counter"));
  app.make({TaskId{std::size_t{0}}}, false);
  auto set = make(app);
  ASSERT_TRUE(set->life().start({}));
  const SignalReport both = set->life().signal(TaskId{std::size_t{1}}, Signal::kOn, {});
  EXPECT_EQ(refusal_text(*set, both), "n would have two producers: a and b");
}

TEST(TaskSet, ConstantsFixExtentsAndReinitialiseExactlyTheirUsers) {
  TestApplication app;
  app.add("arm", component<Arm>("arm"));
  app.add("user", component<User>("user"));
  app.add("counter", component<Counter>("counter"));
  app.extend(0, 1, 10, "ndof");
  app.extend(1, 1, 10, "ndof");
  app.make();
  auto set = make(app);
  ASSERT_TRUE(set->life().start({}));
  run_cycle(*set, 1, milliseconds(1));
  std::int32_t inits;
  std::memcpy(&inits, view(*set, "inits").value, sizeof inits);
  EXPECT_EQ(inits, 103);  // one init, three elements
  EXPECT_EQ(set->tasks()[2].profile.execution[CHIMERA_REINIT].count, 0u);
  static_cast<Arm*>(set->tasks()[0].instance)->wanted_ = 4;
  ASSERT_TRUE(set->life().signal(TaskId{std::size_t{0}}, Signal::kReinit, {}).is_accepted);
  run_cycle(*set, 1, milliseconds(2));
  std::memcpy(&inits, view(*set, "inits").value, sizeof inits);
  EXPECT_EQ(inits, 204);
  EXPECT_EQ(set->tasks()[2].profile.execution[CHIMERA_REINIT].count, 0u);
}

TEST(TaskSet, AnExtentAboveItsMaximumIsAFaultOfInit) {
  TestApplication app;
  app.add("arm", component<Arm>("arm"));
  app.extend(0, 1, 2, "ndof");
  app.make();
  auto set = make(app);
  const auto started = start_result(*set, set->life().start({}));
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().message.view(), "init: extent ndof = 3 of port q is outside 1 to 2");
  EXPECT_EQ(set->tasks()[0].state, State::kNotCreated);
}

TEST(TaskSet, AListMustBeAsLongAsTheConstantSays) {
  TestApplication app;
  add_arm_and_user(app);
  app.port(1, 1).listed[0] = 4;
  app.make();
  auto set = make(app);
  const auto started = start_result(*set, set->life().start({}));
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().message.view(), "init: q has a list of 4 values, but ndof is 3");
}

TEST(TaskSet, OperatorVariablesHoldTheirInitialValue) {
  TestApplication app;
  app.add("reader", component<Reader>("reader"));
  app.give(app.operators, "n", CHIMERA_FLOAT64, testing::bytes_of(2.5));
  app.make();
  auto set = make(app);
  ASSERT_TRUE(set->life().start({}));
  run_cycle(*set, 0, milliseconds(1));
  EXPECT_EQ(number(*set, "seen"), 2.5);
}

TEST(TaskSet, RefusesAVariableWithoutAProducer) {
  TestApplication app;
  app.add("reader", component<Reader>("reader"));
  app.make();
  const auto set = HeapTaskSet::create(app.spec, app.components);
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().message.view(), "no task produces state variable n");
}

TEST(TaskSet, WorksInBytesThatItIsGivenAndTakesNoMoreWhileItRuns) {
  TestApplication app;
  add_arm_and_user(app);
  app.give(app.operators, "gain", CHIMERA_FLOAT64, testing::bytes_of(1.0));
  app.make();
  alignas(kCacheLine) static std::byte bytes[96 * 1024];
  GivenMemory memory(bytes);
  TaskSet set(app.spec, {}, memory);
  ASSERT_TRUE(set.build(app.components));
  ASSERT_TRUE(set.life().start({}));
  const std::size_t used = memory.used();
  EXPECT_GT(used, 0u);
  for (int i = 1; i < 10; ++i) run_cycle(set, 1, milliseconds(i));
  static_cast<Arm*>(set.tasks()[0].instance)->wanted_ = 4;
  ASSERT_TRUE(set.life().signal(TaskId{std::size_t{0}}, Signal::kReinit, {}));
  run_cycle(set, 1, milliseconds(10));
  std::int32_t inits;
  std::memcpy(&inits, view(set, "inits").value, sizeof inits);
  EXPECT_EQ(inits, 204) << "initialised twice, four elements";
  set.life().shut_down(milliseconds(11));
  EXPECT_EQ(memory.used(), used);
}

TEST(TaskLife, KillsArmedTaskAndHotStandbyAlthoughTheirOffFails) {
  TestApplication app;
  app.add("jammed", component<Jammed>("jammed"));
  app.make();
  for (const bool is_armed : {true, false}) {
    const auto set = make(app);
    const Task& task = set->tasks()[0];
    ASSERT_TRUE(set->life().signal(task.id, Signal::kSpawn, {}));
    EXPECT_TRUE(is_armed ? set->life().arm(task.id, {}) : set->life().warm_up(task.id, {}));
    EXPECT_EQ(task.standing, is_armed ? Standing::kOwesOff : Standing::kWarm);
    EXPECT_EQ(task.shown_state(), State::kOff);
    EXPECT_TRUE(set->life().signal(task.id, Signal::kKill, {}));
    EXPECT_EQ(task.faults.off_count, 1u);
    EXPECT_EQ(task.state, State::kNotCreated);
    EXPECT_EQ(task.standing, Standing::kPlain);
  }
}

}  // namespace
}  // namespace chimera
