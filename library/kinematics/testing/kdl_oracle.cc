// SPDX-License-Identifier: Apache-2.0
#include "library/kinematics/testing/kdl_oracle.h"

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

namespace chimera::library {
namespace {

Vec3 triple(const KDL::Vector& v) { return {v(0), v(1), v(2)}; }

KDL::Segment fixed(const Pose& pose) {
  const auto [w, x, y, z] = pose.orientation;
  const KDL::Vector place(pose.position[0], pose.position[1], pose.position[2]);
  return KDL::Segment(KDL::Joint(KDL::Joint::None), KDL::Frame(KDL::Rotation::Quaternion(x, y, z, w), place));
}

KDL::Chain segments(const DhChain& chain) {
  KDL::Chain made;
  made.addSegment(fixed(chain.base));
  for (std::size_t i = 0; i < chain.ndof; ++i) {
    const DhLink& link = chain.dh[i];
    made.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(link.a, link.alpha, link.d, 0)));
  }
  made.addSegment(fixed(chain.tool));
  return made;
}

}  // namespace

struct KdlArm::Solvers {
  explicit Solvers(const DhChain& given)
      : links(given.dh), chain(segments(given)), forward(chain), slopes(chain), angles(chain.getNrOfJoints()),
        jacobian(chain.getNrOfJoints()) {}

  std::array<DhLink, kMostJoints> links;
  KDL::Chain chain;
  KDL::ChainFkSolverPos_recursive forward;
  KDL::ChainJntToJacSolver slopes;
  KDL::JntArray angles;
  KDL::Jacobian jacobian;
  KDL::Frame tool;
};

KdlArm::KdlArm(const DhChain& chain) : solvers_(std::make_unique<Solvers>(chain)) {}
KdlArm::~KdlArm() = default;

void KdlArm::solve(std::span<const double> q) {
  for (unsigned i = 0; i < solvers_->angles.rows(); ++i) solvers_->angles(i) = q[i] + solvers_->links[i].theta;
  solvers_->forward.JntToCart(solvers_->angles, solvers_->tool);
  solvers_->slopes.JntToJac(solvers_->angles, solvers_->jacobian);
}

Frame KdlArm::tool_frame(Jacobian& jacobian) const {
  for (unsigned i = 0; i < solvers_->angles.rows(); ++i) {
    jacobian.linear[i] = triple(solvers_->jacobian.getColumn(i).vel);
    jacobian.angular[i] = triple(solvers_->jacobian.getColumn(i).rot);
  }
  const KDL::Frame& tool = solvers_->tool;
  return {triple(tool.p), triple(tool.M.UnitX()), triple(tool.M.UnitY()), triple(tool.M.UnitZ())};
}

}  // namespace chimera::library
