// SPDX-License-Identifier: Apache-2.0
#include "library/kinematics/kdl_oracle.h"

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

namespace chimera::library {
namespace {

Triple triple(const KDL::Vector& v) { return {v(0), v(1), v(2)}; }

}  // namespace

void ask_kdl(const DhChain& chain, std::vector<ArmPose>& poses) {
  KDL::Chain segments;
  for (std::size_t i = 0; i < chain.ndof; ++i) {
    const DhLink& link = chain.dh[i];
    segments.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(link.a, link.alpha, link.d, 0)));
  }
  KDL::ChainFkSolverPos_recursive forward(segments);
  KDL::ChainJntToJacSolver slopes(segments);
  const auto joints = static_cast<unsigned>(chain.ndof);
  KDL::JntArray angles(joints);
  KDL::Jacobian jacobian(joints);
  for (ArmPose& pose : poses) {
    for (unsigned i = 0; i < joints; ++i) angles(i) = pose.q[i] + chain.dh[i].theta;
    KDL::Frame tool;
    forward.JntToCart(angles, tool);
    slopes.JntToJac(angles, jacobian);
    pose.tool = {triple(tool.p), triple(tool.M.UnitX()), triple(tool.M.UnitY()), triple(tool.M.UnitZ())};
    for (unsigned i = 0; i < joints; ++i) {
      pose.jacobian.linear[i] = triple(jacobian.getColumn(i).vel);
      pose.jacobian.angular[i] = triple(jacobian.getColumn(i).rot);
    }
  }
}

}  // namespace chimera::library
