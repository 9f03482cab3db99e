// SPDX-License-Identifier: Apache-2.0
#include "library/kinematics/dh_of_axes.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "chimera/base/math.h"

namespace chimera::library {
namespace {

void expect_near(const Frame& found, const Frame& expected, double within) {
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.origin[i], expected.origin[i], within);
    EXPECT_NEAR(found.x[i], expected.x[i], within);
    EXPECT_NEAR(found.y[i], expected.y[i], within);
    EXPECT_NEAR(found.z[i], expected.z[i], within);
  }
}

// Turns `point` about an axis, without Denavit and Hartenberg.
Vec3 rotate(const JointAxis& axis, double angle, const Vec3& v) {
  const Vec3 k = (1 / length(axis.direction)) * axis.direction;
  return std::cos(angle) * v + std::sin(angle) * cross(k, v) + (1 - std::cos(angle)) * dot(k, v) * k;
}

Frame by_axes(const std::vector<JointAxis>& axes, const Frame& tool, const std::vector<double>& q) {
  Frame frame = tool;
  for (std::size_t i = axes.size(); i-- > 0;) {
    frame.origin = axes[i].point + rotate(axes[i], q[i], frame.origin - axes[i].point);
    frame.x = rotate(axes[i], q[i], frame.x);
    frame.y = rotate(axes[i], q[i], frame.y);
    frame.z = rotate(axes[i], q[i], frame.z);
  }
  return frame;
}

std::vector<JointAxis> axes_of(const DhChain& chain) {
  std::vector<JointAxis> axes;
  Frame frame = frame_of(chain.base);
  for (std::size_t i = 0; i < chain.ndof; ++i) {
    axes.push_back({frame.origin, frame.z});
    frame = frame * frame_of(chain.dh[i], 0);
  }
  return axes;
}

TEST(DhOfAxes, FindsThePumasOwnTable) {
  DhChain puma;
  puma.ndof = 6;
  puma.dh = {DhLink{0, math::kPi / 2, 0, 0},       {.4318, 0, 0, 0},   {.0203, -math::kPi / 2, .15005, 0},
             {0, math::kPi / 2, .4318, 0}, {0, -math::kPi / 2, 0, 0}, {0, 0, .05625, 0}};
  const std::vector<double> zero(6, 0.0);
  const DhChain found = dh_of_axes(axes_of(puma), tool_frame(puma, zero));
  ASSERT_EQ(found.ndof, 6u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(found.base.position[i], 0);
  EXPECT_EQ(found.base.orientation[0], 1);
  EXPECT_EQ(found.tool.orientation[0], 1);
  // Two parallel joints may share the offset of the third link in either row; the first row has it here.
  EXPECT_NEAR(found.dh[1].a, .4318, 1e-12);
  EXPECT_NEAR(found.dh[1].d + found.dh[2].d, .15005, 1e-12);
  EXPECT_NEAR(found.dh[2].a, .0203, 1e-12);
  EXPECT_NEAR(found.dh[5].d, .05625, 1e-12);
}

TEST(DhOfAxes, MovesTheToolAsTheAxesDo) {
  std::mt19937 random(41);
  std::uniform_real_distribution<double> metre(-1, 1), rad(-3, 3);
  std::uniform_int_distribution<int> kind(0, 3);
  for (int trial = 0; trial < 3000; ++trial) {
    const std::size_t n = 1 + static_cast<std::size_t>(trial) % kMostJoints;
    std::vector<JointAxis> axes;
    std::vector<double> q;
    for (std::size_t i = 0; i < n; ++i) {
      JointAxis axis{{metre(random), metre(random), metre(random)}, {metre(random), metre(random), metre(random)}};
      const int how = i == 0 ? (trial % 2) : kind(random);
      if (i == 0 && how == 0) axis = {{0, 0, metre(random)}, {0, 0, 1}};
      if (i > 0 && how == 1) axis.direction = axes[i - 1].direction;                  // parallel
      if (i > 0 && how == 2) axis.point = axes[i - 1].point + axes[i - 1].direction;  // meeting
      if (i > 0 && how == 3) axis = {axes[i - 1].point, -2.0 * axes[i - 1].direction};  // the same line, backwards
      axes.push_back(axis);
      q.push_back(rad(random));
    }
    const Frame tool = frame_of(DhLink{metre(random), rad(random), metre(random), rad(random)}, 0);
    const DhChain chain = dh_of_axes(axes, tool);
    expect_near(tool_frame(chain, q), by_axes(axes, tool, q), 2e-5);
    if (HasFailure()) FAIL() << "trial " << trial << " with " << n << " joints";
  }
}

TEST(DhOfAxes, AFrameIsAPoseAndBack) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> rad(-3.1, 3.1);
  for (int trial = 0; trial < 2000; ++trial) {
    const Frame frame = frame_of(DhLink{1, rad(random), 2, rad(random)}, 0) * frame_of(DhLink{0, rad(random), 0, 0}, 1);
    expect_near(frame_of(pose_of(frame)), frame, 1e-12);
    EXPECT_GE(pose_of(frame).orientation[0], 0);
  }
}

}  // namespace
}  // namespace chimera::library
