// SPDX-License-Identifier: Apache-2.0
// Against a reference that nobody here wrote: Orocos KDL.
#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

#include "library/kinematics/kdl_oracle.h"
#include "library/kinematics/puma560.h"
#include "library/kinematics/singular_values.h"

namespace chimera::library {
namespace {

using Joints = std::array<double, kMostJoints>;

struct RandomArms {
  std::mt19937 random{2026};
  double within(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random); }
  double metre() { return within(-0.5, 0.5); }
  double rad() { return within(-std::numbers::pi, std::numbers::pi); }
  double right_angle() { return std::uniform_int_distribution<int>(-2, 2)(random) * std::numbers::pi / 2; }

  Pose place() {
    Pose made{{metre(), metre(), metre()}, {within(-1, 1), within(-1, 1), within(-1, 1), within(0.1, 1)}};
    double square = 0;
    for (double part : made.orientation) square += part * part;
    for (double& part : made.orientation) part /= std::sqrt(square);
    return made;
  }
  /// A plain one has right angles and lengths of 0, as real arms have.
  DhChain chain(std::size_t joints, bool is_plain) {
    DhChain made;
    made.ndof = joints;
    for (std::size_t i = 0; i < joints; ++i) {
      made.dh[i] = {is_plain && i % 3 == 0 ? 0 : metre(), is_plain ? right_angle() : rad(),
                    is_plain && i % 2 == 0 ? 0 : metre(), is_plain ? right_angle() : rad()};
    }
    if (is_plain) return made;
    made.base = place();
    made.tool = place();
    return made;
  }
  /// Each tenth stands at right angles and the next nearly so: where plain arms are singular, and near it.
  Joints joints(std::size_t pose) {
    Joints q;
    for (double& angle : q) angle = pose % 10 > 1 ? rad() : right_angle() + (pose % 10 == 1 ? within(-1e-6, 1e-6) : 0);
    return q;
  }
};

double apart(const Triple& a, const Triple& b) { return length(a - b); }
double apart(const Frame& a, const Frame& b) {
  return std::max({apart(a.origin, b.origin), apart(a.x, b.x), apart(a.y, b.y), apart(a.z, b.z)});
}
double apart(const Jacobian& a, const Jacobian& b, std::size_t ndof) {
  double farthest = 0;
  for (std::size_t i = 0; i < ndof; ++i) {
    farthest = std::max({farthest, apart(a.linear[i], b.linear[i]), apart(a.angular[i], b.angular[i])});
  }
  return farthest;
}

TEST(AgainstKdl, ForwardKinematicsAndJacobianOverAHundredThousandPosesOfAThousandArms) {
  RandomArms random;
  double farthest = 0;
  std::size_t judged = 0, near_singular = 0;
  for (std::size_t c = 0; c < 1000; ++c) {
    const DhChain chain = random.chain(1 + c % kMostJoints, c % 2 == 0);
    const SerialArm arm(chain);
    KdlArm kdl(chain);
    for (std::size_t p = 0; p < 100; ++p) {
      const Joints q = random.joints(p);
      Jacobian ours, theirs;
      kdl.solve(q);
      const Frame tool = arm.tool_frame(q, ours);
      farthest = std::max({farthest, apart(tool, kdl.tool_frame(theirs)), apart(ours, theirs, chain.ndof)});
      ++judged;
      if (p % 10 < 2 && c % 10 < 4 && SingularValues(ours, chain.ndof).least() < 1e-5) ++near_singular;
    }
  }
  EXPECT_EQ(judged, 100000u);
  EXPECT_GT(near_singular, 1000u);
  EXPECT_LT(farthest, 1e-12);
}

TEST(AgainstKdl, ThePumaInClosedForm) {
  RandomArms random;
  DhChain chain;
  chain.ndof = Puma560::kJoints;
  std::copy(Puma560::kRows.begin(), Puma560::kRows.end(), chain.dh.begin());
  KdlArm kdl(chain);
  double farthest = 0;
  for (std::size_t p = 0; p < 10000; ++p) {
    const Joints q = random.joints(p);
    Jacobian ours, theirs;
    kdl.solve(q);
    const Frame tool = Puma560::forward(std::span<const double, 6>(q.data(), 6), ours);
    farthest = std::max({farthest, apart(tool, kdl.tool_frame(theirs)), apart(ours, theirs, chain.ndof)});
  }
  EXPECT_LT(farthest, 1e-12);
}

}  // namespace
}  // namespace chimera::library
