// SPDX-License-Identifier: Apache-2.0
// The test components do what their first lines say: tests of the floors above rely on it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>

#include "chimera/task/geometry.h"
#include "chimera/task/rig.h"

namespace chimera {
namespace {

TEST(Kinds, EveryPlainTypeGoesThrough) {
  Rig rig("t_values");
  EXPECT_EQ(rig.get<Text<32>>("echo"), "idle");
  rig.set("flag", true);
  rig.set("small", std::int32_t{2147483646});
  rig.set("large", std::int64_t{1} << 60);
  rig.set("single", 1.5f);
  rig.set("real", 2.5);
  rig.set("text", Text<32>("moving"));
  ASSERT_TRUE(rig.cycle());
  EXPECT_FALSE(rig.get<bool>("not_flag"));
  EXPECT_EQ(rig.get<std::int32_t>("small_next"), 2147483647);
  EXPECT_EQ(rig.get<std::int64_t>("large_next"), (std::int64_t{1} << 60) + 1);
  EXPECT_EQ(rig.get<float>("single_half"), 0.75f);
  EXPECT_EQ(rig.get<double>("real_half"), 1.25);
  EXPECT_EQ(rig.get<Text<32>>("echo"), "moving");
  EXPECT_EQ(rig.get<Text<8>>("words", 1), "two");
}

TEST(Kinds, StructsGoThrough) {
  Rig rig("t_struct");
  rig.set("pose", Pose{{0, 0, 0}, {1, 0, 0, 0}});
  ASSERT_TRUE(rig.on());
  rig.set("pose", Pose{{0.5, 0, -1}, {1, 0, 0, 0}});
  ASSERT_TRUE(rig.cycle(milliseconds(500)));
  EXPECT_DOUBLE_EQ(rig.get<Twist>("twist").linear[0], 1.0);
  EXPECT_DOUBLE_EQ(rig.get<Wrench>("wrench").force[2], 1.0);
}

TEST(Kinds, AListOfAnyTypeIsCopiedByItsBytes) {
  Rig rig("t_generic");
  rig.extent("n", 3);
  for (std::size_t i = 0; i < 16; ++i) rig.set("x", 1.0 + static_cast<double>(i), i);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int32_t>("size"), 3);
  EXPECT_EQ(rig.get<double>("y", 2), 3.0);
  EXPECT_NE(rig.get<double>("y", 3), 4.0);  // beyond the extent in use
}

TEST(Kinds, RepeatedPortsAreDoubledOneByOne) {
  Rig rig("t_repeat");
  rig.instances("in", 2);
  rig.instances("out", 3);
  rig.set("in", 4.0, 0, 0);
  rig.set("in", 5.0, 0, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("out", 0, 1), 10.0);
  EXPECT_EQ(rig.get<double>("out", 0, 2), -1.0);
  EXPECT_EQ(rig.get<std::int32_t>("inputs"), 2);
}

TEST(Kinds, AConstantFixesExtentsAndMatricesHaveNoGaps) {
  Rig rig("t_extent");
  rig.set("ndof", 2);
  for (std::size_t i = 0; i < 2; ++i) {
    rig.set("length", 2.0, i);
    rig.set("q", 3.0 + static_cast<double>(i), i);
  }
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.size("outer"), 4u);
  EXPECT_EQ(rig.get<double>("outer", 3), 16.0);  // row 1, column 1
  EXPECT_EQ(rig.get<double>("arc", 1), 8.0);
  EXPECT_EQ(rig.get<double>("identity", 8), 1.0);
  EXPECT_EQ(rig.get<double>("last", 2), 3.0);
}

TEST(Kinds, ConstantsAreMadeAnewByReinit) {
  Rig rig("t_constants");
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.get<int>("ndof"), 3);
  EXPECT_EQ(rig.size("length"), 3u);
  EXPECT_EQ(rig.get<double>("length", 2), 1.5);
  rig.set("joints", 5);
  ASSERT_TRUE(rig.reinit());
  EXPECT_EQ(rig.size("length"), 5u);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<int>("inits"), 2);
}

TEST(Kinds, AResourceThatDoesNotExistIsRefusedInInit) {
  Rig rig("t_resource");
  rig.resource("file", "/nowhere/number");
  EXPECT_EQ(rig.init().text, "the file cannot be opened");
  const std::string path = "/tmp/t_resource_" + std::to_string(::getpid());
  std::ofstream(path) << "12.5\n";
  rig.resource("file", path.c_str());
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("number"), 12.5);
  EXPECT_TRUE(rig.kill());
  std::remove(path.c_str());
}

TEST(Kinds, ASafetyPortGoesWrongOnDemand) {
  Rig rig("t_safety");
  rig.set("bad_at", std::int64_t{1});
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("command"), 0.001);
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("command")));
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("command"), 0.003);
}

TEST(Kinds, TheThrowerFailsInTheConfiguredMethodAndWay) {
  const char* const texts[] = {"thrown on demand", "an exception that is not a std::exception", "refused on demand",
                               "text on demand"};
  for (int how = 1; how <= 4; ++how) {
    for (const char* where : {"init", "reinit", "on", "cycle", "off", "kill", "error", "clear"}) {
      Rig rig("t_thrower");
      rig.set("where", Text<16>(where));
      rig.set("how", how);
      const RigAnswer answers[] = {rig.init(), rig.reinit(), rig.on(),    rig.cycle(),
                                   rig.off(),  rig.kill(),   rig.error(), rig.clear()};
      int faults = 0;
      for (const RigAnswer& answer : answers) {
        if (answer.status == CHIMERA_OK) continue;
        ++faults;
        EXPECT_EQ(answer.text, texts[how - 1]) << where;
      }
      EXPECT_EQ(faults, 1) << where << " " << how;
    }
  }
}

TEST(Kinds, EventsComeAtEveryThirdCall) {
  Rig rig("t_events");
  EXPECT_EQ(rig.sync().status, CHIMERA_NO_EVENT);
  EXPECT_EQ(rig.sync().status, CHIMERA_NO_EVENT);
  EXPECT_TRUE(rig.sync());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<std::int64_t>("events"), 1);
}

TEST(Kinds, TheSenderSendsOnceInItsCycle) {
  Rig rig("t_sender");
  rig.set("target", Text<64>("pid"));
  rig.set("at", std::int64_t{1});
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.signals(), std::vector<std::string>{"off pid"});
  EXPECT_EQ(rig.get<std::int32_t>("sent"), 1);
}

TEST(Kinds, DelaysAreShownWhenItGoesOff) {
  Rig delays("t_delays");
  ASSERT_TRUE(delays.on());
  for (int n = 0; n < 3; ++n) ASSERT_TRUE(delays.cycle());
  EXPECT_EQ(delays.get<std::int64_t>("counts", 255), 0);
  ASSERT_TRUE(delays.off());
  EXPECT_EQ(delays.get<std::int64_t>("counts", 255), 3) << "the time of this rig began long after the clock's";
}

TEST(Kinds, SourceCounterAgesAndUnits) {
  Rig source("t_source");
  ASSERT_TRUE(source.on());
  EXPECT_TRUE(std::isnan(source.get<double>("x")));
  source.set("spend", std::int64_t{5000});
  ASSERT_TRUE(source.cycle(milliseconds(250)));
  EXPECT_DOUBLE_EQ(source.get<double>("x"), 0.25);
  EXPECT_EQ(source.spent(), microseconds(5));

  Rig counter("t_counter");
  counter.set("count", std::int64_t{41});
  ASSERT_TRUE(counter.cycle());
  EXPECT_EQ(counter.get<std::int64_t>("count"), 42);

  Rig ages("t_ages");
  ASSERT_TRUE(ages.cycle());
  EXPECT_EQ(ages.get<double>("age"), -1);

  Rig units("t_units");
  units.set("a", 6.0);
  units.set("b", 4.0);
  ASSERT_TRUE(units.cycle());
  EXPECT_EQ(units.get<double>("product"), 24.0);
  EXPECT_EQ(units.get<double>("ratio"), 1.5);

  Rig allocator("t_allocator");
  ASSERT_TRUE(allocator.cycle());
  EXPECT_EQ(allocator.get<std::int64_t>("allocations"), 1);
}

}  // namespace
}  // namespace chimera
