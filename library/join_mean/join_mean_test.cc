// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct Joined : Rig {
  Joined(std::uint32_t inputs, std::uint32_t weights) : Rig("join_mean") {
    instances("in", inputs);
    instances("weight", weights);
  }
};

TEST(JoinMean, IsTheMeanWithoutWeights) {
  Joined rig(3, 0);
  for (std::size_t i = 0; i < 3; ++i) rig.set("in", static_cast<double>(i), 0, i);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("out"), 1.0);
}

TEST(JoinMean, WeighsEachInput) {
  Joined rig(2, 2);
  rig.set("in", 10.0, 0, 0);
  rig.set("in", 20.0, 0, 1);
  rig.set("weight", 3.0, 0, 0);
  rig.set("weight", 1.0, 0, 1);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_DOUBLE_EQ(rig.get<double>("out"), 12.5);
}

TEST(JoinMean, LeavesOutInvalidInputs) {
  Joined rig(2, 0);
  rig.set("in", 7.0, 0, 1);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("out"), 7.0);
}

TEST(JoinMean, HoldsWhenNothingIsValidOrAllWeightsAreZero) {
  Joined rig(2, 2);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("out")));  // never written
  rig.set("in", 7.0, 0, 0);
  ASSERT_TRUE(rig.cycle());
  rig.set("weight", 0.0, 0, 0);
  rig.set("in", 9.0, 0, 0);
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("out"), 7.0);
}

TEST(JoinMean, RefusesWeightsThatDoNotMatch) {
  Joined none(0, 0);
  EXPECT_EQ(none.init().text, "there is nothing to join: name at least one input");
  Joined other(3, 2);
  EXPECT_EQ(other.init().text, "give one weight for each input, or none");
}

TEST(JoinMean, IsOverNaNWithTheNextGoodInput) {
  Joined rig(2, 0);
  rig.set("in", 7.0, 0, 0);
  rig.set("in", std::nan(""), 0, 1);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.cycle());
  EXPECT_TRUE(std::isnan(rig.get<double>("out")));
  rig.set("in", 9.0, 0, 1);
  ASSERT_TRUE(rig.cycle());
  EXPECT_DOUBLE_EQ(rig.get<double>("out"), 8.0);
}

}  // namespace
}  // namespace chimera
