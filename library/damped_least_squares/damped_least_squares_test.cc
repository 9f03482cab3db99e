// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "chimera/task/rig.h"
#include "library/kinematics/puma560.h"
#include "library/kinematics/serial_arm.h"

namespace chimera {
namespace {

using library::Puma560;

struct DampedLeastSquaresTest : testing::Test {
  Rig rig{"damped_least_squares"};
  library::DhChain chain;

  DampedLeastSquaresTest() {
    chain.ndof = 6;
    std::copy(Puma560::kRows.begin(), Puma560::kRows.end(), chain.dh.begin());
    rig.set("ndof", std::int32_t{6});
    rig.set("speed_limit", 2.0);
  }
  void stand(const Puma560::Vector& q) {
    library::Jacobian jacobian;
    rig.set("xm", library::pose_of(library::tool_frame(chain, q, jacobian)));
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        rig.set("jv", jacobian.linear[i][r], r * 6 + i);
        rig.set("jw", jacobian.angular[i][r], r * 6 + i);
      }
    }
  }
  double fastest() {
    double most = 0;
    for (std::size_t i = 0; i < 6; ++i) most = std::max(most, std::abs(rig.get<double>("qd_ref", i)));
    return most;
  }
};

TEST_F(DampedLeastSquaresTest, BringsTheToolToItsTarget) {
  Puma560::Vector q{0.3, 0.6, -2.6, 0.4, 0.8, -0.2};
  const Pose goal = library::pose_of(Puma560::forward(Puma560::Vector{0.4, 0.7, -2.5, 0.5, 0.7, -0.1}));
  rig.set("xd", goal);
  stand(q);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  for (int step = 0; step < 2000; ++step) {
    stand(q);
    ASSERT_TRUE(rig.cycle());
    ASSERT_LE(fastest(), 2.0 + 1e-12);
    for (std::size_t i = 0; i < 6; ++i) q[i] += rig.get<double>("qd_ref", i) * 1e-3;
  }
  const Pose end = library::pose_of(Puma560::forward(q));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(end.position[i], goal.position[i], 1e-6);
}

TEST_F(DampedLeastSquaresTest, StaysBoundedNearASingularWrist) {
  rig.set("speed_limit", 100.0);
  rig.set("gain", 1.0);
  const Puma560::Vector q{0.3, 0.6, -2.6, 0.4, 1e-3, -0.2};
  stand(q);
  Pose goal = rig.get<Pose>("xm");
  goal.position[0] += 0.05;
  goal.position[1] += 0.05;
  rig.set("xd", goal);
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_LT(rig.get<double>("manipulability"), 2e-3);
  EXPECT_LT(fastest(), 1.0);
  EXPECT_GT(fastest(), 0.01);
}

TEST_F(DampedLeastSquaresTest, StopsWithoutGainAtOffAndWhileTheConfigurationIsIllegal) {
  const Puma560::Vector q{0.3, 0.6, -2.6, 0.4, 0.8, -0.2};
  stand(q);
  rig.set("xd", Pose{{0.3, 0.3, 0.3}, {1, 0, 0, 0}});
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_GT(fastest(), 0);
  rig.illegal(true);
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(fastest(), 0);
  rig.illegal(false);
  ASSERT_TRUE(rig.cycle());
  ASSERT_TRUE(rig.off());
  EXPECT_EQ(fastest(), 0);
  rig.set("gain", 0.0);
  ASSERT_TRUE(rig.reinit());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(fastest(), 0);
}

TEST_F(DampedLeastSquaresTest, RefusesWhatIsNotFinite) {
  stand({0.3, 0.6, -2.6, 0.4, 0.8, -0.2});
  rig.set("xd", Pose{{std::nan(""), 0, 0}, {1, 0, 0, 0}});
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.cycle().text, "a pose is not finite");
  rig.set("xd", Pose{{0.3, 0, 0}, {1, 0, 0, 0}});
  rig.set("jv", std::nan(""), 3);
  EXPECT_EQ(rig.cycle().text, "the Jacobian is not finite");
}

}  // namespace
}  // namespace chimera
