// SPDX-License-Identifier: Apache-2.0
// A switch over real-time units, stepped in virtual time: the variable u of plant gets another producer in the same
// unit, or in the other one, or by way of a new task in the other one.
#include "chimera/rtpu/switch_links.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "chimera/rtpu/testing/test_units.h"

namespace chimera {
namespace {

using testing::component;
using testing::TestApplication;
using testing::Units;

using Log = std::vector<std::tuple<std::int64_t, double>>;

/// What the components of a run do, and what they saw. One run at a time.
struct Scene {
  Log plant, beacon, u, reader;
  std::vector<std::string> story;
  double on_of_two = 0;
  bool on_of_two_fails = false;
  int illegal = 0;  // cycles that saw the flag up
};
Scene scene;

struct Plant {
  In<double> u{"u", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle c) {
    *y = *y + 0.1 * (*u - *y);
    scene.plant.emplace_back(c.now().count, *y);
    scene.u.emplace_back(c.now().count, *u);
    scene.illegal += c.illegal() ? 1 : 0;
  }
};

struct Beacon {  // knows nobody
  Out<double> b{"b", "1", initial = 0.0};
  void cycle(Cycle c) {
    *b = *b * 0.9 + static_cast<double>(c.now().count % 997);
    scene.beacon.emplace_back(c.now().count, *b);
  }
};

/// Reads u in the other unit.
struct Reader {
  In<double> u{"u", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  void cycle(Cycle c) {
    *seen = *u;
    scene.reader.emplace_back(c.now().count, *u);
    scene.illegal += c.illegal() ? 1 : 0;
  }
};

struct One {  // 7 while it cycles
  Out<double> u{"u", "1", initial = 0.0};
  void on(Cycle) { scene.story.emplace_back("on one"); }
  void cycle(Cycle) { *u = 7; }
  void off(Cycle) {
    scene.story.emplace_back("off one");
    *u = 1e6;  // nobody may see this
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

struct Two {  // 7 from its first cycle on, what on says before
  In<double> z{"z", "1"};
  Out<double> u{"u", "1", initial = 0.0};
  Outcome on(Cycle) {
    scene.story.emplace_back("on two");
    if (scene.on_of_two_fails) return fault("no current");
    *u = *u + scene.on_of_two;
    return ok();
  }
  void cycle(Cycle) { *u = 7; }
  void off(Cycle) {
    scene.story.emplace_back("off two");
    *u = 1e6;
  }
};

constexpr TaskId kPlant{0u}, kBeacon{1u}, kReader{2u}, kOne{3u}, kObserver{4u}, kTwo{5u}, kThree{6u};
constexpr std::uint32_t kDirect = 0, kObserved = 1, kBeside = 2;

struct SwitchLinksTest : ::testing::Test {
  SwitchLinksTest() { make(); }
  void make() {
    scene = {};
    units.reset();
    app = std::make_unique<TestApplication>();
    app->rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    const auto add = [this](const char* name, const chimera_component* what, std::uint32_t rtpu) {
      app->add(name, what).rtpu = RtpuId(rtpu);
    };
    add("plant", component<Plant>("plant"), 0);
    add("beacon", component<Beacon>("beacon"), 0);
    add("reader", component<Reader>("reader"), 1);
    add("one", component<One>("one"), 1);
    add("observer", component<Observer>("observer"), 0);
    add("two", component<Two>("two"), 1);
    add("three", component<Two>("two"), 0);  // in the unit of plant
    app->link(kThree.index, 0, "y");
    if (limit > 0) app->port(kTwo.index, 1).max_step = std::as_bytes(std::span(&limit, 1));
    app->make({kPlant, kBeacon, kReader, kOne}, false);
    app->spec.sets = sets;
    units = std::make_unique<Units>(*app);
    units->run(milliseconds(1));
    for (std::uint32_t t = 0; t <= kThree.index; ++t) {
      units->send(Signal::kSpawn, {TaskId(t)});
      units->run(milliseconds(1));
    }
    for (const TaskId task : direct) units->send(Signal::kOn, {task});
    units->run(milliseconds(10));
    scene.illegal = 0;
    scene.story.clear();
  }
  State state(TaskId task) const { return units->units[app->tasks[task.index].rtpu.index]->state(task); }
  bool are_on(const std::vector<TaskId>& set) const {
    for (std::uint32_t t = 0; t <= kThree.index; ++t)
      if ((state(TaskId(t)) == State::kOn) != (std::ranges::find(set, TaskId(t)) != set.end())) return false;
    return true;
  }
  const TaskPart& part(std::uint32_t u, TaskId task) const {
    const SwitchPart& all = units->part(u);
    const auto end = all.tasks.begin() + all.n_tasks;
    const auto found = std::find_if(all.tasks.begin(), end, [task](const TaskPart& p) { return p.task == task; });
    EXPECT_NE(found, end);
    return *found;
  }
  std::uint64_t lost() const {
    std::uint64_t n = 0;
    for (const auto& unit : units->units)
      for (const Task& task : unit->tasks->tasks()) n += task.profile.dropped + task.profile.missed;
    return n;
  }

  std::vector<TaskId> direct{kPlant, kBeacon, kReader, kOne}, observed{kPlant, kBeacon, kReader, kObserver, kTwo},
      beside{kPlant, kBeacon, kReader, kThree};
  NamedSet sets[3] = {{"direct", direct}, {"observed", observed}, {"beside", beside}};
  double limit = 0;
  std::unique_ptr<TestApplication> app;
  std::unique_ptr<Units> units;
};

TEST_F(SwitchLinksTest, TwoUnitsChangeAtOneInstant) {
  const std::uint16_t number = units->switch_to(kObserved);
  units->run(milliseconds(10));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(0).number, number);
  EXPECT_EQ(units->part(0).end, SwitchEnd::kDone);
  EXPECT_EQ(units->part(1).end, SwitchEnd::kDone);
  EXPECT_EQ(units->part(0).at, units->part(1).at);
  EXPECT_TRUE(are_on(observed));
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on observer", "on two", "off one"}));
  EXPECT_FALSE(units->flag_is_up());
  EXPECT_EQ(scene.illegal, 0);
  EXPECT_EQ(lost(), 0u);
  EXPECT_EQ(units->part(0).n_tasks, 3u);  // plant, beacon, observer
  EXPECT_EQ(units->part(1).n_tasks, 3u);  // reader, one, two
  EXPECT_EQ(part(1, kOne).move, TaskMove::kLeaves);
  EXPECT_GE(part(1, kOne).off, Nanoseconds{});
  EXPECT_EQ(units->part(1).n_variables, 1u);  // u; z goes to a task of the first unit
  EXPECT_TRUE(units->part(1).variables[0].step_of_on.is_known);
}

TEST_F(SwitchLinksTest, WhoStaysSeesNothingOfTenThousandSwitches) {
  const Nanoseconds begin = units->now;
  std::mt19937 random(5);
  std::vector<std::uint32_t> wanted;
  std::uint32_t at_present = kDirect;
  for (int i = 0; i < 10'000; ++i) {
    std::uint32_t next = random() % 2;
    if (next >= at_present) ++next;
    at_present = next;
    const std::uint16_t number = units->switch_to(next, microseconds(300 + random() % 500));
    units->run(microseconds(100 * (40 + random() % 20)));
    ASSERT_TRUE(units->is_over(number)) << i;
    for (const std::uint32_t u : {0u, 1u}) {
      const SwitchPart& told = units->part(u);
      ASSERT_EQ(told.number, number);
      ASSERT_EQ(told.end, SwitchEnd::kDone) << i << " " << static_cast<int>(told.why);
      for (std::uint32_t t = 0; t < told.n_tasks; ++t) ASSERT_EQ(told.tasks[t].lost, 0u) << i;
    }
    ASSERT_TRUE(are_on(at_present == kDirect ? direct : at_present == kObserved ? observed : beside)) << i;
    ASSERT_FALSE(units->flag_is_up());
  }
  EXPECT_EQ(scene.illegal, 0);
  EXPECT_EQ(lost(), 0u);
  const Nanoseconds passed = units->now - begin;
  const Log plant = scene.plant, beacon = scene.beacon, u = scene.u, reader = scene.reader;
  make();
  units->run(passed);
  EXPECT_TRUE(plant == scene.plant);
  EXPECT_TRUE(beacon == scene.beacon);
  EXPECT_TRUE(u == scene.u);
  EXPECT_TRUE(reader == scene.reader);
}

TEST_F(SwitchLinksTest, AnOnThatFailsInOneUnitUndoesWhatTheOtherHasArmed) {
  scene.on_of_two_fails = true;
  const std::uint16_t number = units->switch_to(kObserved);
  units->run(milliseconds(10));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(0).end, SwitchEnd::kAborted);
  EXPECT_EQ(units->part(0).why, NoSwitch::kNone) << "the other unit aborted";
  EXPECT_EQ(units->part(1).why, NoSwitch::kOnFailed);
  EXPECT_EQ(units->part(1).task, kTwo);
  EXPECT_STREQ(units->part(1).said, "no current");
  EXPECT_EQ(scene.story, (std::vector<std::string>{"on observer", "on two", "off observer"}));
  EXPECT_TRUE(are_on(direct));
  EXPECT_EQ(scene.illegal, 0);
}

TEST_F(SwitchLinksTest, AStepOfOnBeyondTheLimitIsSeenAcrossUnits) {
  limit = 0.5;
  make();
  scene.on_of_two = 0.6;
  const std::uint16_t number = units->switch_to(kObserved);
  units->run(milliseconds(10));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(1).why, NoSwitch::kStepTooLarge);
  EXPECT_TRUE(are_on(direct));
}

TEST_F(SwitchLinksTest, ASignalToAMemberAborts) {
  const std::uint16_t number = units->switch_to(kObserved);
  units->send(Signal::kOff, {kOne});
  units->run(milliseconds(10));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(1).end, SwitchEnd::kAborted);
  EXPECT_EQ(state(kOne), State::kOff);
  EXPECT_EQ(state(kTwo), State::kOff);
  EXPECT_EQ(state(kObserver), State::kOff);
  EXPECT_TRUE(units->flag_is_up());  // nobody produces u
}

TEST_F(SwitchLinksTest, TheDeathOfAMemberBeforeTheChangeAborts) {
  const std::uint16_t number = units->switch_to(kBeside);
  units->die(1);
  units->run(milliseconds(10));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(0).end, SwitchEnd::kAborted);
  EXPECT_EQ(units->part(0).why, NoSwitch::kMemberDied);
  EXPECT_EQ(state(kThree), State::kOff);
  EXPECT_TRUE(units->flag_is_up());
}

// The unit of the leaving producer dies when all have agreed: nobody waits for it.
TEST_F(SwitchLinksTest, TheDeathOfAMemberAfterTheCommitDoesNotHoldUpTheChange) {
  const std::uint16_t number = units->switch_to(kBeside, milliseconds(5));
  SwitchAgreement agreement(units->decision.switching, units->keeper.origin);
  while (agreement.plan().phase != SwitchPhase::kCommitted) units->run(microseconds(100));
  units->die(1);
  units->run(milliseconds(10));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(0).end, SwitchEnd::kDone);
  EXPECT_EQ(state(kThree), State::kOn);
  EXPECT_EQ(std::get<1>(scene.u.back()), 7);
}

TEST_F(SwitchLinksTest, ASuccessorAbortsWhatItsPredecessorTookPartIn) {
  const std::uint16_t number = units->switch_to(kBeside);
  units->start(1, 2);
  units->change();
  units->run(milliseconds(20));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(0).end, SwitchEnd::kAborted);
  EXPECT_EQ(units->part(1).end, SwitchEnd::kAborted);
  EXPECT_EQ(state(kThree), State::kOff);
}

TEST_F(SwitchLinksTest, AnOrderThatNobodyWroteIsAborted) {
  const std::uint16_t number = units->switch_to(kObserved);
  units->decision.switching.order[3] ^= 4096;
  units->run(milliseconds(10));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(0).why, NoSwitch::kDamaged);
  EXPECT_TRUE(are_on(direct));
  EXPECT_EQ(scene.illegal, 0);
}

TEST_F(SwitchLinksTest, WithoutTimeToAgreeItIsAborted) {
  const std::uint16_t number = units->switch_to(kObserved, Nanoseconds{});
  units->run(milliseconds(10));
  ASSERT_TRUE(units->is_over(number));
  EXPECT_EQ(units->part(0).end, SwitchEnd::kAborted);
  EXPECT_TRUE(are_on(direct));
  EXPECT_EQ(lost(), 0u);
  EXPECT_EQ(scene.illegal, 0);
}

}  // namespace
}  // namespace chimera
