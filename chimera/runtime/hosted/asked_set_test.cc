// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/hosted/asked_set.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

using testing::component;
using testing::TestApplication;

struct Sensor {
  Out<double> q{"q", "1"};
  void cycle(Cycle) {}
};
struct Controller {
  In<double> q{"q", "1"};
  Out<double> u{"u", "1"};
  void cycle(Cycle) {}
};
struct Filtered {
  In<double> z{"z", "1"};
  Out<double> u{"u", "1"};
  void cycle(Cycle) {}
};
struct Filter {
  In<double> q{"q", "1"};
  Out<double> z{"z", "1"};
  void cycle(Cycle) {}
};
struct Motor {
  In<double> u{"u", "1"};
  void cycle(Cycle) {}
};
struct Circle {
  In<double> u{"u", "1"};
  Out<double> z{"z", "1"};
  void cycle(Cycle) {}
};

struct Tool {
  OutConst<double> mass{"mass", "kg"};
  Out<double> held{"held", "1"};
  void cycle(Cycle) {}
};

struct Valve {
  Out<double> flow{"flow", "1"};
  Resource port{"port"};
  void cycle(Cycle) {}
};

constexpr TaskId kSensor{0u}, kPid{1u}, kSmooth{2u}, kFilter{3u}, kMotor{4u}, kSpare{5u}, kCircle{6u},
    kGripper{7u}, kWelder{8u}, kWater{9u}, kAir{10u};

struct AskedSetTest : ::testing::Test {
  AskedSetTest() {
    app.add("sensor", component<Sensor>("sensor"));
    app.add("pid", component<Controller>("controller"));
    app.add("smooth", component<Filtered>("filtered"));
    app.add("filter", component<Filter>("filter"));
    app.add("motor", component<Motor>("motor"));
    app.add("spare", component<Filter>("filter"));
    app.add("circle", component<Circle>("circle"));
    app.add("gripper", component<Tool>("tool"));
    app.add("welder", component<Tool>("tool"));
    app.add("water", component<Valve>("valve"));
    app.add("air", component<Valve>("valve"));
    app.link(kAir.index, 0, "flow_of_air");
    for (const TaskId valve : {kWater, kAir}) app.port(valve.index, 1).value = tty;
    for (TaskSpec& task : app.tasks) task.rtpu = RtpuId{0u};
    app.link(kSpare.index, 1, "z2");
    make();
  }
  void make() { app.make({}, false); }
  /// "sensor pid motor", or why not.
  std::string ask(std::vector<TaskId> plus, std::vector<TaskId> minus = {}) {
    const AskedSet asked = asked_set(app.spec, bits_of(are_on), {bits_of(plus), bits_of(minus)});
    if (!asked) return asked.text();
    std::string names;
    for (std::size_t t = 0; t < app.spec.tasks.size(); ++t)
      if (asked.tasks.has(TaskId(t))) append_joined(names, " ", app.spec.tasks[t].name);
    return names;
  }
  std::vector<TaskId> are_on{kSensor, kPid, kMotor};
  const std::array<std::byte, 4> tty{std::byte{'t'}, std::byte{'t'}, std::byte{'y'}, std::byte{'0'}};
  TestApplication app;
};

TEST_F(AskedSetTest, ATaskWithTheSameResourceGivesWay) {
  are_on.push_back(kWater);
  EXPECT_EQ(ask({kAir}), "sensor pid motor air");
  EXPECT_EQ(ask({kAir, kWater}), "tasks 'water' and 'air' open the same resource 'tty0'; one of the two with `--off`");
  EXPECT_EQ(ask({}, {kWater}), "sensor pid motor");
}

TEST_F(AskedSetTest, ARivalProducerGivesWayAndTheOnlyProducerComesAlong) {
  app.link(kCircle.index, 1, "nothing_else");
  make();
  EXPECT_EQ(ask({kSmooth}), "sensor smooth filter motor");
}

TEST_F(AskedSetTest, AChoiceIsRefusedWithTheCandidates) {
  EXPECT_EQ(ask({kSmooth}), "z would have no producer, and there is a choice: 'filter' or 'circle'; `--on` with one of "
                            "them");
  EXPECT_EQ(ask({kSmooth, kFilter}), "sensor smooth filter motor");
}

TEST_F(AskedSetTest, AddsAMissingProducerOnlyForATaskThatIsAskedFor) {
  app.link(kCircle.index, 1, "nothing_else");
  make();
  EXPECT_EQ(ask({kSmooth}, {kFilter}), "z would have no producer");
  EXPECT_EQ(ask({}, {kSensor}), "q would have no producer");
  EXPECT_EQ(ask({}, {kMotor}), "sensor pid");
  EXPECT_EQ(ask({kSpare}), "sensor pid motor spare");
}

TEST_F(AskedSetTest, ContradictionsAreRefused) {
  EXPECT_EQ(ask({kFilter}, {kFilter}), "task 'filter' cannot be both ON and OFF");
  EXPECT_EQ(ask({kPid, kSmooth, kFilter}), "u would have two producers: pid and smooth");
  EXPECT_EQ(ask({}, {kSensor, kPid, kMotor}), "no task would be ON");
}

TEST_F(AskedSetTest, ALoopWithoutAnInitialValueIsRefused) {
  EXPECT_EQ(ask({kSmooth, kCircle}), "a loop of data would have no initial value, among: smooth motor circle");
  const double zero = 0;
  app.port(kCircle.index, 1).value = std::as_bytes(std::span(&zero, 1));
  make();
  EXPECT_EQ(ask({kSmooth, kCircle}), "sensor smooth motor circle");
}

TEST_F(AskedSetTest, RefusesASetThatTakesMoreOfACpuThanCheckAllows) {
  app.tasks[kSensor.index].budget = microseconds(500);
  app.tasks[kSpare.index].budget = microseconds(430);
  make();
  EXPECT_EQ(ask({kSpare}), "sensor pid motor spare");
  app.tasks[kSpare.index].budget = microseconds(440);
  make();
  EXPECT_EQ(ask({kSpare}),
            "the budgets would take 0.940 of CPU 0; expected at most 0.93; turn other tasks of that CPU OFF");
}

TEST_F(AskedSetTest, CountsTheLoadOfHotStandbysAndOfTakeovers) {
  app.tasks[kSensor.index].budget = microseconds(500);
  app.tasks[kSpare.index].budget = microseconds(440);
  make();
  StandbySpec pair{kSensor, kSpare, {}, true};
  app.spec.standbys = {&pair, 1};
  EXPECT_EQ(ask({kWater}),
            "the budgets would take 0.940 of CPU 0; expected at most 0.93; turn other tasks of that CPU OFF");
  pair.hot = false;
  EXPECT_EQ(ask({kWater}), "sensor pid motor water");
  app.tasks[kSpare.index].budget = microseconds(960);
  EXPECT_EQ(ask({kWater}), "the budgets with 'spare' for 'sensor' would take 0.960 of CPU 0; expected at most 0.93; "
                           "turn other tasks of that CPU OFF");
}

TEST_F(AskedSetTest, CountsTheLoadOfAllRtpusWhereTheyShareACpu) {
  app.tasks[kSensor.index].budget = microseconds(500);
  app.tasks[kSpare.index].budget = microseconds(440);
  app.tasks[kSpare.index].rtpu = RtpuId{1u};
  make();
  const RtpuSpec rtpus[] = {{.name = "main", .cpu = 0}, {.name = "second", .cpu = 1}};
  app.spec.rtpus = rtpus;
  const TaskBits on = bits_of(are_on);
  const TaskLists lists{bits_of(std::vector{kSpare}), {}};
  EXPECT_TRUE(asked_set(app.spec, on, lists));
  EXPECT_EQ(asked_set(app.spec, on, lists, true).why,
            "the budgets would take 0.940 of CPU 0; expected at most 0.93");
}

TEST_F(AskedSetTest, AcceptsAConfigurationThatVerificationAccepted) {
  app.tasks[kSensor.index].budget = microseconds(990);
  make();
  EXPECT_EQ(ask({kWater}),
            "the budgets would take 0.990 of CPU 0; expected at most 0.93; turn other tasks of that CPU OFF");
  const std::array order{kSensor, kPid, kMotor, kWater};
  const NamedSet set{"watered", order};
  app.spec.sets = {&set, 1};
  EXPECT_EQ(ask({kWater}), "sensor pid motor water");
}

TEST_F(AskedSetTest, WhichProducerGivesAConstantOnlyAConfigurationSays) {
  EXPECT_EQ(ask({kGripper}), "which of its producers gives constant mass, only a configuration says, and these tasks "
                             "are none; `chimera switch` with the name of a configuration");
}

}  // namespace
}  // namespace chimera
