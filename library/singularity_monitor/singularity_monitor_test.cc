// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "chimera/base/math.h"
#include "library/kinematics/testing/arm_rig.h"
#include "library/kinematics/singular_values.h"

namespace chimera {
namespace {

using library::Jacobian;
using library::Puma560;
using library::SingularValues;

Jacobian of_puma(const Puma560::Vector& q) {
  Jacobian jacobian;
  Puma560::forward(q, jacobian);
  return jacobian;
}

TEST(SingularValues, AreTheLengthsOfOrthogonalMotions) {
  Jacobian jacobian;
  jacobian.linear = {library::Vec3{3, 0, 0}, {0, 2, 0}, {0, 0, 5}};
  jacobian.angular[3] = {0, 0, 0.5};
  const SingularValues four(jacobian, 4);
  EXPECT_DOUBLE_EQ(four.least(), 0.5);
  EXPECT_DOUBLE_EQ(four.greatest(), 5);
  EXPECT_DOUBLE_EQ(SingularValues(jacobian, 3, 2).least(), 1);  // 2 m count as 1 rad
  EXPECT_EQ(SingularValues(jacobian, 6).least(), 0);
}

TEST(SingularValues, TheirProductIsTheDeterminant) {
  const Puma560::Vector nominal{0, math::kPi / 4, math::kPi, 0, math::kPi / 4, 0};
  EXPECT_NEAR(SingularValues(of_puma(nominal), 6).manipulability(), 0.078617, 5e-7);  // published for this pose
}

TEST(SingularValues, AreFoundWithinTheBoundAndAreSmallWhereThePumaIsSingular) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(-math::kPi, math::kPi), little(-1e-9, 1e-9);
  int most = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Puma560::Vector q;
    for (double& joint : q) joint = angle(random);
    if (trial % 4 == 1) q[4] = little(random);                                          // the wrist
    if (trial % 4 == 2) q[2] = -std::atan2(Puma560::d4, Puma560::a3) + little(random);  // the elbow
    if (trial % 4 == 3) q = {q[0], 0, 0, 0, little(random), 0};                         // the wrist, at right angles
    const SingularValues values(of_puma(q), 6);
    most = std::max(most, values.sweeps());
    if (trial % 4 != 0) {
      ASSERT_LT(values.least(), 1e-8);
    }
  }
  EXPECT_LE(most, 8);
  EXPECT_LT(most, SingularValues::kMostSweeps);
}

struct SingularityMonitorTest : ::testing::Test {
  library::ArmRig rig{"singularity_monitor"};
  void SetUp() override { rig.set("ndof", std::int32_t{6}); }
  void stand(const Puma560::Vector& q) { rig.give_jacobian(of_puma(q), 6); }
  bool is_near_at(double wrist) {
    stand({0, math::kPi / 4, -math::kPi, 0, wrist, 0});
    EXPECT_TRUE(rig.cycle());
    return rig.get<bool>("is_near");
  }
};

TEST_F(SingularityMonitorTest, IsNearBelowOneValueUntilAboveTheOther) {
  ASSERT_TRUE(rig.init());
  stand({0, math::kPi / 4, -math::kPi, 0, 0.8, 0});
  ASSERT_TRUE(rig.on());
  EXPECT_FALSE(rig.get<bool>("is_near"));
  const auto value = [this] { return rig.get<double>("singular_value"); };
  EXPECT_TRUE(is_near_at(0.02));
  EXPECT_LT(value(), 0.05);
  double wrist = 0.02;
  while (value() < 0.055) EXPECT_TRUE(is_near_at(wrist += 0.01));  // between the thresholds: still near
  while (value() < 0.085) is_near_at(wrist += 0.01);
  EXPECT_FALSE(is_near_at(wrist));
  while (value() > 0.06) EXPECT_EQ(is_near_at(wrist -= 0.01), value() < 0.05);  // and still clear
}

TEST_F(SingularityMonitorTest, CountsAsNearAtOnUntilItIsSeenToBeClear) {
  ASSERT_TRUE(rig.init());
  stand({0, math::kPi / 4, -math::kPi, 0, 0, 0});
  ASSERT_TRUE(rig.on());
  EXPECT_TRUE(rig.get<bool>("is_near"));
  EXPECT_NEAR(rig.get<double>("singular_value"), 0, 1e-12);
  EXPECT_NEAR(rig.get<double>("isotropy"), 0, 1e-12);
}

TEST_F(SingularityMonitorTest, AsksOnceForEachApproachAndWhenItHasBeenClearForDwell) {
  rig.set("when_near", Text<64>("figure_9"));
  rig.set("when_clear", Text<64>("figure_8"));
  rig.set("dwell", 0.01);
  ASSERT_TRUE(rig.init());
  stand({0, math::kPi / 4, -math::kPi, 0, 0.8, 0});
  ASSERT_TRUE(rig.on());
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(is_near_at(0.8));
  EXPECT_TRUE(rig.signals().empty()) << "clear from the beginning: nothing to change";
  std::vector<std::string> asked{"request figure_9"};
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(is_near_at(0.02));
  EXPECT_EQ(rig.signals(), asked);
  for (int i = 0; i < 9; ++i) is_near_at(0.8);
  is_near_at(0.02);  // within dwell: still figure 9
  for (int i = 0; i < 9; ++i) is_near_at(0.8);
  EXPECT_EQ(rig.signals(), asked);
  is_near_at(0.8);
  asked.emplace_back("request figure_8");
  EXPECT_EQ(rig.signals(), asked);
  is_near_at(0.02);
  asked.emplace_back("request figure_9");
  EXPECT_EQ(rig.signals(), asked);
}

TEST_F(SingularityMonitorTest, AsksForNothingWithoutNames) {
  ASSERT_TRUE(rig.init());
  stand({0, math::kPi / 4, -math::kPi, 0, 0, 0});
  ASSERT_TRUE(rig.on());
  is_near_at(0.02);
  EXPECT_TRUE(rig.signals().empty());
}

TEST_F(SingularityMonitorTest, RefusesAJacobianThatIsNotFiniteOrTooLarge) {
  ASSERT_TRUE(rig.init());
  for (const double bad : {std::nan(""), HUGE_VAL, 1e200}) {
    stand({0, math::kPi / 4, -math::kPi, 0, 0.8, 0});
    rig.set("jw", bad, 7);
    const RigAnswer answer = rig.cycle();
    EXPECT_FALSE(answer);
    EXPECT_EQ(answer.text, "the Jacobian is not finite, or too large");
  }
  stand({0, math::kPi / 4, -math::kPi, 0, 0.8, 0});
  EXPECT_TRUE(rig.cycle());
}

TEST_F(SingularityMonitorTest, RefusesLimitsBetweenWhichItWouldChatter) {
  rig.set("near", 0.1);
  rig.set("clear_of", 0.09);
  const RigAnswer answer = rig.init();
  EXPECT_FALSE(answer);
  EXPECT_EQ(answer.text, "clear_of is below near: is_near would chatter");
}

}  // namespace
}  // namespace chimera
