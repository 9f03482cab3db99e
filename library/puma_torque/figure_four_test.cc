// SPDX-License-Identifier: Apache-2.0
// Runs figure 4 of the 1994 paper at 1 kHz on the plain classes. The gains of examples/01_puma_pid were tuned here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chimera/base/math.h"
#include "library/joint_trajectory/quintic.h"
#include "library/pid/pid_axis.h"
#include "library/puma_torque/puma_arm.h"

namespace chimera::library {
namespace {

constexpr PumaVector kStart{0, math::kPi / 2, -math::kPi / 2, 0, 0, 0};
constexpr PumaVector kGoal{0.8, math::kPi / 2 - 0.7, -math::kPi / 2 + 0.7, 0.6, -0.6, 0.8};
constexpr double kDt = 1e-3, kMove = 1.8, kEnd = 4.0, kFilter = 2e-3;
constexpr PumaVector kKp{2500, 3500, 1200, 250, 250, 250};
constexpr PumaVector kKi{5000, 12000, 4000, 800, 800, 800};
constexpr PumaVector kKd{150, 250, 60, 12, 12, 12};

struct Figures {
  PumaVector furthest{};  ///< rad, largest error
  PumaVector last{};      ///< rad, from the goal at the end
  PumaVector moved{};     ///< rad, from the start at 2 s
  PumaVector peak{};      ///< N.m
};

Figures run(double payload_mass) {
  PumaArm arm;
  EXPECT_TRUE(arm.load(kPumaModel, {.payload_mass = payload_mass}));
  EXPECT_TRUE(arm.place(kStart));
  std::array<PidAxis, kPumaJoints> pid;
  PumaVector tau{};
  Figures figures;
  for (std::size_t j = 0; j < kPumaJoints; ++j) pid[j].start({kKp[j], kKi[j], kKd[j]}, 0, 0, 0);
  for (double t = kDt; t < kEnd; t += kDt) {
    EXPECT_TRUE(arm.step(tau, kDt));
    for (std::size_t j = 0; j < kPumaJoints; ++j) {
      const Motion reference = Quintic{kStart[j], kGoal[j], kMove}.at(t);
      const double error = reference.position - arm.position()[j];
      tau[j] = pid[j].step({kKp[j], kKi[j], kKd[j]}, error, reference.velocity - arm.velocity()[j], kDt, kFilter,
                           -arm.torque_limit()[j], arm.torque_limit()[j]);
      figures.furthest[j] = std::max(figures.furthest[j], std::abs(error));
      figures.peak[j] = std::max(figures.peak[j], std::abs(tau[j]));
      figures.last[j] = std::abs(error);
      if (t <= 2.0) figures.moved[j] = std::abs(arm.position()[j] - kStart[j]);
    }
  }
  return figures;
}

TEST(FigureFour, EveryJointMovesHalfARadianFollowsAndArrives) {
  for (double payload_mass : {0.0, 1.5, 3.0}) {
    const Figures figures = run(payload_mass);
    for (std::size_t j = 0; j < kPumaJoints; ++j) {
      EXPECT_GT(figures.moved[j], 0.5) << "joint " << j + 1 << ", payload " << payload_mass;
      EXPECT_LT(figures.furthest[j], 10e-3) << "joint " << j + 1 << ", payload " << payload_mass;
      EXPECT_LT(figures.last[j], 0.1e-3) << "joint " << j + 1 << ", payload " << payload_mass;
      EXPECT_LT(figures.peak[j], 40) << "joint " << j + 1 << ", payload " << payload_mass;
    }
  }
}

TEST(FigureFour, PayloadShowsInTheTrackingError) {
  const Figures light = run(1.5), heavy = run(3.0);
  EXPECT_GT(heavy.furthest[1], light.furthest[1] + 0.3e-3);
  EXPECT_GT(heavy.peak[1], light.peak[1] + 3);
}

}  // namespace
}  // namespace chimera::library
