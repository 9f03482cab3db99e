// SPDX-License-Identifier: Apache-2.0
// Computes joint speeds for a tool error that stay bounded at singular poses (1994 paper, figure 9).
#include "library/kinematics/dh_ports.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct DampedLeastSquares {
  In<Pose> xd{"xd", frame = "base", doc = "Desired tool pose."};
  In<Pose> xm{"xm", frame = "base", doc = "Measured tool pose."};
  In<Matrix<double>> jv{"jv", "m/rad", "[3][ndof<=10]", frame = "base", doc = "Tool velocity by joint speeds."};
  In<Matrix<double>> jw{"jw", "1", "[3][ndof<=10]", frame = "base", doc = "Angular tool velocity by joint speeds."};
  Out<double[]> qd_ref{"qd_ref", "rad/s", "[ndof<=10]", initial = 0.0, frame = "joint", doc = "Joint speeds."};
  Out<double> manipulability{"manipulability", "1", initial = 0.0, doc = "sqrt(det J J^T): 0 at a singular pose."};
  InConst<std::int32_t> ndof{"ndof", "1", range(1, 10), doc = "Joints."};
  InConst<double> gain{"gain", "1/s", initial = 10.0, range(0, 100),
                       doc = "Rate at which an error of the tool decays."};
  InConst<double> damping{"damping", "1", initial = 0.05, range(1e-6, 1), doc = "Damping at a singular pose."};
  InConst<double> threshold{"threshold", "1", initial = 0.02, range(1e-9, 10),
                            doc = "Manipulability below which damping begins."};
  InConst<double> speed_limit{"speed_limit", "rad/s", initial = 2.0, range(0.01, 100), doc = "Largest joint speed."};

  void init() { reinit(); }
  void reinit() {
    if (!(*speed_limit > 0) || !(*threshold > 0) || !std::isfinite(*damping) || !std::isfinite(*gain))
      throw std::runtime_error("speed_limit and threshold must be above 0, damping and gain finite");
    inverse_.damping = *damping;
    inverse_.threshold = *threshold;
  }
  // Bumpless: speeds that are handed over hold until the first cycle. Otherwise the speeds are 0.
  void on() {
    if (!qd_ref.is_handed_over() || !library::all_finite(qd_ref)) stop();
  }
  Outcome cycle(Cycle c) {
    stop();
    if (c.illegal()) return ok();
    if (!library::DhPorts::is_pose(*xd) || !library::DhPorts::is_pose(*xm)) {
      return library::unfit("a pose is not finite, or has no orientation", xd, xm);
    }
    library::Vec6 e = library::motion_between(library::frame_of(*xm), library::frame_of(*xd));
    for (double& part : e) part *= *gain;
    library::Jacobian jacobian;
    double sum = 0;  // sum of squares: the matrix of the solution must be finite, too
    for (std::size_t i = 0; i < qd_ref.size(); ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        jacobian.linear[i][r] = jv(r, i);
        jacobian.angular[i][r] = jw(r, i);
        sum += jv(r, i) * jv(r, i) + jw(r, i) * jw(r, i);
      }
    }
    if (!(sum < kMost)) return library::unfit("the Jacobian is not finite, or too large", jv, jw);
    move(jacobian, e);
    return ok();
  }
  void off() { stop(); }

 private:
  static constexpr double kMost = 1e20;  // above this the solution would have no correct digit

  void stop() {
    for (double& speed : qd_ref) speed = 0;
  }
  void move(const library::Jacobian& jacobian, const library::Vec6& e) {
    std::array<double, library::kMostJoints> speed{};
    inverse_.solve(jacobian, qd_ref.size(), e, speed);
    *manipulability = inverse_.manipulability();
    double fastest = 0;
    for (double s : speed) fastest = std::max(fastest, std::abs(s));
    const double share = fastest > *speed_limit ? *speed_limit / fastest : 1;
    for (std::size_t i = 0; i < qd_ref.size(); ++i) qd_ref[i] = share * speed[i];
  }

  library::DampedInverse inverse_;
};

CHIMERA_COMPONENT(DampedLeastSquares, "damped_least_squares", "Joint speeds for a tool error, bounded everywhere.",
                  rate = 1000.0, source = "1994 paper, figure 9; Wampler 1986; Nakamura and Hanafusa 1986");

}  // namespace
