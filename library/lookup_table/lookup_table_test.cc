// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "library/signals/testing/signal_rig.h"

namespace chimera {
namespace {

struct Table : SignalRig {
  Table() : SignalRig("lookup_table") {}
  RigAnswer make(const std::vector<double>& at, const std::vector<double>& value, const char* outside = "hold") {
    extent("points", static_cast<std::uint32_t>(at.size()));
    for (std::size_t k = 0; k < at.size(); ++k) set("at", at[k], k), set("value", value[k], k);
    set("outside", Text<16>(outside));
    return init();
  }
};

TEST(LookupTable, IsItsPointsAndStraightBetweenThem) {
  Table rig;
  ASSERT_TRUE(rig.make({-1, 0, 0.3, 10}, {5, 1, 0.1, 100.7}));
  EXPECT_EQ(rig.step(-1), 5);
  EXPECT_EQ(rig.step(0), 1);
  EXPECT_EQ(rig.step(0.3), 0.1);
  EXPECT_EQ(rig.step(10), 100.7);
  EXPECT_DOUBLE_EQ(rig.step(-0.25), 2);
  EXPECT_DOUBLE_EQ(rig.step(0.1), 0.7);
  EXPECT_DOUBLE_EQ(rig.step(5.15), 50.4);
}

// Compares with the sum of hinge functions, another form of the same curve.
TEST(LookupTable, IsTheSumOfItsHingesEverywhere) {
  Table rig;
  std::vector<double> at, value;
  for (int k = 0; k < 256; ++k) at.push_back(k + 0.4 * std::sin(k)), value.push_back(std::cos(0.3 * k));
  ASSERT_TRUE(rig.make(at, value, "extend"));
  for (double x = -3; x < 259; x += 0.173) {
    double sum = value[0], slope = 0;
    for (std::size_t k = 0; k + 1 < at.size(); ++k) {
      const double next = (value[k + 1] - value[k]) / (at[k + 1] - at[k]);
      sum += (next - slope) * (k == 0 ? x - at[0] : std::max(x - at[k], 0.0));
      slope = next;
    }
    ASSERT_NEAR(rig.step(x), sum, 1e-9) << x;
  }
}

TEST(LookupTable, HoldsExtendsOrRefusesOutside) {
  Table rig;
  ASSERT_TRUE(rig.make({0, 1, 3}, {0, 2, 4}));
  EXPECT_EQ(rig.step(-1), 0);
  EXPECT_EQ(rig.step(1e308), 4);
  ASSERT_TRUE(rig.make({0, 1, 3}, {0, 2, 4}, "extend"));
  EXPECT_EQ(rig.step(-1), -2);
  EXPECT_EQ(rig.step(5), 6);
  ASSERT_TRUE(rig.make({0, 1, 3}, {0, 2, 4}, "fault"));
  EXPECT_EQ(rig.step(3), 4);
  rig.set("x", 3.5);
  EXPECT_EQ(rig.cycle().text, "x is 3.5, and the table goes from 0 to 3");
  EXPECT_TRUE(rig.error());
  EXPECT_EQ(rig.get<double>("y"), 4);
  EXPECT_EQ(rig.step(1), 2);
}

TEST(LookupTable, IsThereFromOnAlready) {
  Table rig;
  ASSERT_TRUE(rig.make({0, 1}, {0, 2}));
  rig.set("x", 0.5);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("y"), 1);
}

TEST(LookupTable, NaNIsAFaultOfThatCycleAlone) {
  Table rig;
  ASSERT_TRUE(rig.make({0, 1}, {0, 2}));
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
  EXPECT_TRUE(std::isnan(rig.step(std::nan(""))));
  EXPECT_EQ(rig.step(0.5), 1);
}

TEST(LookupTable, RefusesAnInvalidTable) {
  EXPECT_EQ(Table().make({0, 1, 1, 2}, {0, 0, 0, 0}).text,
            "at[2] is 1, after 1: each point of at must be above the one before");
  EXPECT_EQ(Table().make({0, -1}, {0, 0}).text, "at[1] is -1, after 0: each point of at must be above the one before");
  EXPECT_EQ(Table().make({0}, {0}).text, "a table has two points or more");
  EXPECT_EQ(Table().make({0, HUGE_VAL}, {0, 0}).text, "at and value must be finite");
  EXPECT_EQ(Table().make({0, 1}, {0, std::nan("")}).text, "at and value must be finite");
  EXPECT_EQ(Table().make({0, 1}, {0, 1}, "clamp").text, "outside must be hold, extend or fault");
}

}  // namespace
}  // namespace chimera
