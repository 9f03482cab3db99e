// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct Summed : Rig {
  Summed(std::uint32_t inputs, std::uint32_t weights, std::uint32_t elements = 1) : Rig("sum") {
    instances("in", inputs);
    instances("weight", weights);
    extent("n", elements);
  }
};

TEST(Sum, AddsWithoutWeights) {
  Summed rig(3, 0);
  for (std::size_t i = 0; i < 3; ++i) rig.set("in", static_cast<double>(i + 1), 0, i);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<double>("out"), 6);  // computed by on: no step in the first cycle
  rig.set("in", 10.0, 0, 2);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("out"), 13);
}

TEST(Sum, TakesAwayWithAWeightBelowZeroAndBeginsWithItsBias) {
  Summed rig(2, 2);
  rig.set("in", 10.0, 0, 0), rig.set("in", 4.0, 0, 1);
  rig.set("weight", 1.0, 0, 0), rig.set("weight", -0.5, 0, 1);
  rig.set("bias", 100.0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("out"), 108);
}

TEST(Sum, AddsElementByElement) {
  Summed rig(2, 0, 3);
  for (std::size_t e = 0; e < 3; ++e)
    rig.set("in", static_cast<double>(e), e, 0), rig.set("in", 10.0 * static_cast<double>(e), e, 1);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  for (std::size_t e = 0; e < 3; ++e) EXPECT_EQ(rig.get<double>("out", e), 11.0 * static_cast<double>(e));
}

TEST(Sum, NamesTheInputThatIsNotFiniteAndIsOverItWithTheNext) {
  Summed rig(2, 0, 2);
  for (std::size_t i = 0; i < 4; ++i) rig.set("in", 1.0, i % 2, i / 2);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  rig.set("in", std::nan(""), 0, 1);
  EXPECT_EQ(rig.cycle().text, "in[1][0] is not a finite number");
  EXPECT_TRUE(rig.error());
  EXPECT_EQ(rig.get<double>("out"), 2);
  rig.set("in", 3.0, 0, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("out"), 4);
}

TEST(Sum, AbortsItsCycleWhileAnInputIsUnwritten) {
  Summed rig(2, 0);
  rig.set("in", 1.0, 0, 0);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
}

TEST(Sum, RefusesWeightsThatDoNotMatch) {
  EXPECT_EQ(Summed(0, 0).init().text, "there is nothing to add: name at least one input");
  EXPECT_EQ(Summed(3, 2).init().text, "give one weight for each input, or none");
  Summed rig(1, 1);
  rig.set("weight", std::nan(""));
  EXPECT_EQ(rig.init().text, "weights must be finite");
  rig.set("weight", 1.0), rig.set("bias", HUGE_VAL);
  EXPECT_EQ(rig.init().text, "bias must be finite");
}

}  // namespace
}  // namespace chimera
