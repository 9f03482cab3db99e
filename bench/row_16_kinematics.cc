// SPDX-License-Identifier: Apache-2.0
// Row 16: forward kinematics and Jacobian of a Puma 560 from its Denavit-Hartenberg rows, beside the closed form and
// beside Orocos KDL in the same run; then one cycle of each kinematics component, beside the bare law it is made of.
// Components: gfwdkin ginvkin pfwdkin pinvkin fwdkin_jacobian damped_least_squares singularity_monitor
// Components: computed_torque time_integrator ctraj cinterp pose_monitor tracking_monitor tool
#include <cmath>
#include <cstdio>

#include "bench/component.h"
#include "library/kinematics/dh_dynamics.h"
#include "library/kinematics/testing/puma560_links.h"
#include "library/kinematics/singular_values.h"
#ifdef CHIMERA_KDL
#include "library/kinematics/testing/kdl_oracle.h"
#endif

namespace chimera {
namespace {

using bench::ComponentCase;
using library::ArmRig;
using library::Frame;
using library::Jacobian;
using library::kBent;
using library::Puma560;
using library::SerialArm;

library::DhChain puma_rows() {
  library::DhChain chain;
  chain.ndof = Puma560::kJoints;
  std::copy(Puma560::kRows.begin(), Puma560::kRows.end(), chain.dh.begin());
  return chain;
}

/// `law(q)` for poses along a path, n times.
template <class Law>
std::function<void(std::uint64_t)> along_a_path(Law law) {
  std::vector<Puma560::Vector> path(64, kBent);
  for (std::size_t p = 0; p < path.size(); ++p) {
    for (double& angle : path[p]) angle += 0.2 * std::sin(0.1 * static_cast<double>(p));
  }
  return [law, path](std::uint64_t n) mutable {
    for (; n > 0; --n) law(path[n % path.size()]);
  };
}

template <class Arm>
auto pose_of_arm(Arm arm) {
  return along_a_path([arm](const Puma560::Vector& q) {
    Jacobian jacobian;
    Frame tool = arm(q, jacobian);
    bench::keep(jacobian);
    bench::keep(tool);
  });
}

void forward_kinematics(int repetitions) {
  bench::Comparison comparison(repetitions);
  const auto closed = comparison.add(
      "closed form", pose_of_arm([](const Puma560::Vector& q, Jacobian& j) { return Puma560::forward(q, j); }));
  const auto ours = comparison.add("from rows", pose_of_arm([arm = SerialArm(puma_rows())](const auto& q, Jacobian& j) {
                                     return arm.tool_frame(q, j);
                                   }));
#ifdef CHIMERA_KDL
  const auto solver = std::make_shared<library::KdlArm>(puma_rows());
  const auto kdl = comparison.add("Orocos KDL", along_a_path([solver](const Puma560::Vector& q) { solver->solve(q); }));
#endif
  comparison.run(closed);
  const std::string what = "Puma pose and Jacobian from rows";
  bench::print(bench::Figure{.row = 16, .what = what, .goal = bench::ratio_at_most(2)}.of(comparison, ours));
#ifdef CHIMERA_KDL
  bench::Figure beside{.row = 16, .what = what, .goal = bench::ratio_at_most(1.0 / 8)};
  beside = beside.of(comparison, ours);
  beside.baseline = comparison.cost(kdl);
  beside.baseline_name = comparison.name(kdl);
  beside.ratio = comparison.ratio(ours, kdl);
  bench::print(beside);
#else
  std::fprintf(stderr, "row 16: not compared with Orocos KDL: liborocos-kdl-dev was not found\n");
#endif
}

Jacobian bent_jacobian() {
  Jacobian jacobian;
  Puma560::forward(kBent, jacobian);
  return jacobian;
}

/// The wanted pose of an inverse: beside where the arm stands, so that the search has some steps to go.
Frame beside_bent() {
  Puma560::Vector q = kBent;
  for (double& angle : q) angle += 0.01;
  return Puma560::forward(q);
}

void give_pose(ArmRig& rig, const char* port, const Frame& frame) { rig.set(port, library::pose_of(frame)); }

std::vector<ComponentCase> forward_cases() {
  const auto give = [](ArmRig& rig) { rig.build_puma(), rig.give("q", kBent); };
  const auto rows = [arm = SerialArm(puma_rows())](const auto& q, Jacobian& j) { return arm.tool_frame(q, j); };
  return {{"gfwdkin", "pose from rows", give, along_a_path([arm = SerialArm(puma_rows())](const Puma560::Vector& q) {
             Pose pose = library::pose_of(arm.tool_frame(q));
             bench::keep(pose);
           })},
          {"fwdkin_jacobian", "pose, Jacobian from rows", give, pose_of_arm(rows)},
          {"pfwdkin", "closed form", [](ArmRig& rig) { rig.give("q", kBent); },
           along_a_path([](const Puma560::Vector& q) {
             Pose pose = library::pose_of(Puma560::forward(q));
             bench::keep(pose);
           })}};
}

std::vector<ComponentCase> inverse_cases() {
  return {{"pinvkin", "8 solutions, nearest",
           [](ArmRig& rig) { rig.give("q", kBent), give_pose(rig, "xr", beside_bent()); },
           [wanted = beside_bent()](std::uint64_t n) {
             for (Puma560::Vector q = kBent; n > 0; --n) Puma560::nearest(wanted, q, q), bench::keep(q);
           }},
          {"ginvkin", "damped search, there", [](ArmRig& rig) {
             rig.build_puma(), rig.give("q", kBent), give_pose(rig, "xr", beside_bent()), rig.set("tolerance", 1e-6);
           },
           [wanted = beside_bent(), arm = SerialArm(puma_rows())](std::uint64_t n) {
             library::PoseSearch search;
             for (Puma560::Vector q = kBent; n > 0; --n) search.solve(arm, wanted, q, 1e-6), bench::keep(q);
           }},
          {"damped_least_squares", "damped inverse", [](ArmRig& rig) {
             rig.set("ndof", std::int32_t{6}), rig.give_jacobian(bent_jacobian(), 6);
             rig.set("gain", 1.0), rig.set("damping", 0.05), rig.set("threshold", 0.02), rig.set("speed_limit", 2.0);
             give_pose(rig, "xm", Puma560::forward(kBent)), give_pose(rig, "xd", beside_bent());
           },
           [jacobian = bent_jacobian()](std::uint64_t n) {
             library::DampedInverse inverse;
             Puma560::Vector speed;
             for (; n > 0; --n) inverse.solve(jacobian, 6, {1, 2, 3, 4, 5, 6}, speed), bench::keep(speed);
           }},
          {"singularity_monitor", "singular values", [](ArmRig& rig) {
             rig.set("ndof", std::int32_t{6}), rig.give_jacobian(bent_jacobian(), 6);
             rig.set("near", 0.05), rig.set("clear_of", 0.08), rig.set("length", 1.0);
           },
           [jacobian = bent_jacobian()](std::uint64_t n) {
             for (; n > 0; --n) {
               library::SingularValues values(jacobian, 6);
               bench::keep(values);
             }
           }}};
}

std::vector<ComponentCase> other_cases() {
  return {
      {"computed_torque", "Newton-Euler",
       [](ArmRig& rig) {
         rig.build_puma();
         for (std::size_t i = 0; i < 6; ++i) rig.set("links", library::kPuma560Links[i], i);
         for (const char* port : {"q", "q_ref", "qd", "qd_ref", "qdd_ref"}) rig.give(port, kBent);
         rig.give("tau_max", Puma560::kHigh);
       },
       along_a_path([arm = library::ArmDynamics(puma_rows(), library::kPuma560Links, {0, 0, -9.81}, 0)](
                        const Puma560::Vector& q) {
         Puma560::Vector torque;
         arm.torque(q, q, q, torque);
         bench::keep(torque);
       })},
      {"time_integrator", "x += v dt", [](ArmRig& rig) { rig.give("rate_of_change", kBent), rig.give("start", kBent); },
       [](std::uint64_t n) {
         for (Puma560::Vector x{}; n > 0; --n) {
           for (std::size_t i = 0; i < 6; ++i) x[i] += kBent[i] * 1e-3;
           bench::keep(x);
         }
       }},
      {"tool", "an empty loop",
       [](ArmRig& rig) {
         rig.set("pose", library::kIdentityPose);
         rig.set("mass", 1.5);
       },
       [](std::uint64_t n) {
         for (; n > 0; --n) bench::keep(n);
       }},
      {"ctraj", "3 std::sin",
       [](ArmRig& rig) {
         rig.set("centre", library::kIdentityPose);
         for (const char* port : {"amplitude", "frequency", "phase"}) rig.give(port, std::array{0.1, 0.2, 0.3});
       },
       [](std::uint64_t n) {
         std::array<double, 3> x{};
         for (double t = 0; n > 0; --n, t += 1e-3) {
           for (std::size_t i = 0; i < 3; ++i) x[i] = 0.1 * std::sin(6.28 * t + static_cast<double>(i));
           bench::keep(x);
         }
       }}};
}

/// The distance and the turn between two poses.
void between_poses(std::uint64_t n) {
  Pose a = library::pose_of(Puma560::forward(kBent)), b = library::pose_of(beside_bent());
  for (; n > 0; --n) {
    bench::keep(a), bench::keep(b);
    double way = 0, turn = 0;
    for (int i = 0; i < 3; ++i) way += (a.position[i] - b.position[i]) * (a.position[i] - b.position[i]);
    for (int i = 0; i < 4; ++i) turn += a.orientation[i] * b.orientation[i];
    way = std::sqrt(way), turn = 2 * std::acos(std::min(1.0, std::abs(turn)));
    bench::keep(way), bench::keep(turn);
  }
}

void step_between_poses(std::uint64_t n) {
  Pose a = library::pose_of(Puma560::forward(kBent));
  const Pose b = library::pose_of(beside_bent());
  for (; n > 0; --n) {
    for (int i = 0; i < 3; ++i) a.position[i] += 0.01 * (b.position[i] - a.position[i]);
    library::turn_towards(a.orientation, b.orientation, 1e-6);
    bench::keep(a);
  }
}

std::vector<ComponentCase> judging_cases() {
  const auto poses = [](ArmRig& rig, const char* wanted) {
    give_pose(rig, "xm", Puma560::forward(kBent)), give_pose(rig, wanted, beside_bent());
  };
  return {{"cinterp", "a step and a turn", [poses](ArmRig& rig) { poses(rig, "xd"); }, step_between_poses},
          {"pose_monitor", "way and turn", [poses](ArmRig& rig) { poses(rig, "target"); }, between_poses},
          {"tracking_monitor", "6 distances", [](ArmRig& rig) {
             rig.set("ndof", std::int32_t{6}), rig.give("q", kBent), rig.give("q_ref", Puma560::kHigh); },
           [](std::uint64_t n) {
             Puma560::Vector q = kBent, to = Puma560::kHigh, most{};
             double worst = 0;
             for (; n > 0; --n) {
               bench::keep(q), bench::keep(to);
               for (std::size_t i = 0; i < 6; ++i) {
                 worst = std::max(worst, std::abs(to[i] - q[i]));
                 most[i] = std::max(most[i], std::abs(q[i] - kBent[i]));
               }
               bench::keep(worst), bench::keep(most);
             }
           }}};
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  using namespace chimera;
  const bench::Stage stage;
  forward_kinematics(bench::repetitions(argc, argv));
  int worst = 0;
  for (const auto& cases : {forward_cases(), inverse_cases(), other_cases(), judging_cases()})
    worst = std::max(worst, bench::measure(16, cases, argc, argv));
  return worst;
}
