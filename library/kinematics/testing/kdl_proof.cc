// SPDX-License-Identifier: Apache-2.0
#include "library/kinematics/testing/kdl_proof.h"

#include <cstdio>

#include "library/kinematics/puma560.h"
#include "library/kinematics/testing/random_arms.h"

namespace chimera::library {
namespace {

constexpr std::size_t kPoses = 20;
constexpr double kSame = 1e-12;    // forward kinematics and Jacobians, m and rad
constexpr double kAgreed = 1e-9;   // inverse kinematics
constexpr double kStretched = 3e-7;  // near a double root of a square root

std::string wrong(unsigned seed, const char* what, std::size_t pose, double by) {
  char text[160];
  std::snprintf(text, sizeof text, "seed %u, pose %zu: %s differs by %.3g", seed, pose, what, by);
  return text;
}

Frame forward(KdlArm& kdl, std::span<const double> q) {
  Jacobian unused;
  kdl.solve(q);
  return kdl.tool_frame(unused);
}

std::string judge_forward(unsigned seed, RandomArms& random, KdlTally& tally) {
  const DhChain chain = random.chain(1 + seed % kMostJoints, seed % 2 == 0);
  const SerialArm arm(chain);
  KdlArm kdl(chain);
  for (std::size_t p = 0; p < kPoses; ++p, ++tally.poses) {
    const Joints q = random.joints(p);
    Jacobian ours, theirs;
    kdl.solve(q);
    const Frame tool = arm.tool_frame(q, ours);
    const double apart = difference(tool, kdl.tool_frame(theirs));
    const double by = std::max(apart, difference(ours, theirs, chain.ndof));
    if (!(by < kSame)) return wrong(seed, "the tool or the Jacobian", p, by);
  }
  return {};
}

std::string judge_puma(unsigned seed, RandomArms& random, KdlArm& kdl, KdlTally& tally) {
  for (std::size_t p = 0; p < kPoses; ++p) {
    const Joints q = random.joints(p);
    const Frame wanted = forward(kdl, q);
    const Puma560::Solutions found = Puma560::inverse(wanted, std::span<const double, 6>(q.data(), 6));
    if (found.count == 0) return wrong(seed, "a pose without a solution", p, 0);
    for (std::size_t s = 0; s < found.count; ++s, ++tally.inverses) {
      const double by = difference(forward(kdl, found.q[s]), wanted);
      if (!(by < (p % 10 < 2 ? kStretched : kAgreed))) return wrong(seed, "a solution led back", p, by);
    }
  }
  return {};
}

std::string judge_search(unsigned seed, RandomArms& random, KdlTally& tally) {
  const DhChain chain = random.chain(6 + seed % 5, seed % 2 == 0);
  const SerialArm arm(chain);
  KdlArm kdl(chain);
  const Joints goal = random.joints(seed % 10);
  const Frame wanted = forward(kdl, goal);
  Joints q = goal;
  for (std::size_t i = 0; i < chain.ndof; ++i) q[i] += random.within(-0.3, 0.3);
  PoseSearch search;
  bool is_solved = false;
  for (int call = 0; call < 10 && !is_solved; ++call) {
    is_solved = search.solve(arm, wanted, {q.data(), chain.ndof}, kAgreed);
  }
  ++tally.searches, tally.solved += is_solved;
  const double by = difference(forward(kdl, q), wanted);
  if (is_solved && !(by < kAgreed)) return wrong(seed, "what the search calls found", 0, by);
  const bool is_honest = search.residual() >= 0.1 || by < search.residual() + kAgreed;
  return is_honest ? std::string() : wrong(seed, "the residual that the search states", 0, by - search.residual());
}

DhChain puma() {
  DhChain chain;
  chain.ndof = Puma560::kJoints;
  std::copy(Puma560::kRows.begin(), Puma560::kRows.end(), chain.dh.begin());
  return chain;
}

}  // namespace

std::string judge_kinematics(unsigned seed, KdlTally& tally) {
  static KdlArm kdl(puma());
  RandomArms random;
  random.random.seed(seed);
  std::string said = judge_forward(seed, random, tally);
  if (said.empty()) said = judge_puma(seed, random, kdl, tally);
  if (said.empty()) said = judge_search(seed, random, tally);
  return said;
}

}  // namespace chimera::library
