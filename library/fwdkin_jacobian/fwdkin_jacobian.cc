// SPDX-License-Identifier: Apache-2.0
// Tool pose and Jacobian of any serial arm (1994 paper, figures 8 and 9).
#include "library/kinematics/dh_ports.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct FwdkinJacobian : library::DhPorts {
  In<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured joint positions."};
  Out<Pose> xm{"xm", frame = "base", doc = "Measured tool pose."};
  Out<Matrix<double>> jv{"jv", "m/rad", "[3][ndof<=10]", frame = "base", doc = "Tool velocity by joint speeds."};
  Out<Matrix<double>> jw{"jw", "1", "[3][ndof<=10]", frame = "base", doc = "Angular tool velocity by joint speeds."};

  void init() { read_chain(); }
  void reinit() { read_chain(); }
  Outcome on() { return library::required(cycle(), "q is not finite"); }
  Outcome cycle() {
    library::Jacobian jacobian;
    const library::Frame found = arm_.tool_frame(q.span(), jacobian);
    if (!std::isfinite(library::length(found.origin) + library::length(found.x)))
      return library::unfit("q is not finite", q);
    *xm = library::pose_of(found);
    for (std::size_t i = 0; i < arm_.joints(); ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        jv(r, i) = jacobian.linear[i][r];
        jw(r, i) = jacobian.angular[i][r];
      }
    }
    return ok();
  }
  bool error() { return true; }
};

CHIMERA_COMPONENT(FwdkinJacobian, "fwdkin_jacobian", "Forward kinematics and Jacobian.", rate = 1000.0,
                  source = "1994 paper, figures 8 and 9");

}  // namespace
