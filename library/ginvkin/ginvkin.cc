// SPDX-License-Identifier: Apache-2.0
// Generalized inverse kinematics: joint positions for a tool pose, for any robot that tells how it is built.
#include "library/kinematics/dh_ports.h"

using namespace chimera;

namespace {

struct Ginvkin : library::DhPorts {
  In<Pose> xr{"xr", frame = "base", doc = "Reference tool pose."};
  In<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint",
                 doc = "Measured joint positions: where the search begins at on."};
  Out<double[]> q_ref{"q_ref", "rad", "[ndof<=10]", initial = 0.0, frame = "joint",
                      doc = "Joint positions for xr, near the last ones."};
  Out<double> residual{"residual", "1", initial = 0.0,
                       doc = "What is missing: the larger of metres and radians; large when xr is out of reach."};
  InConst<double> tolerance{"tolerance", "1", initial = 1e-6, range(1e-9, 0.1), doc = "Metres and radians."};

  void init() { read_chain(); }
  void reinit() { read_chain(); }
  Outcome on() {
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (!std::isfinite(q[i])) return fault("q is not finite: the search cannot begin there");
      q_ref[i] = q[i];
    }
    return ok();
  }
  Outcome cycle(Cycle c) {
    if (c.illegal()) return ok();
    if (!is_pose(*xr)) return fault("xr is not finite or no orientation");
    std::array<double, library::kMostJoints> q_found{};
    std::copy_n(q_ref.begin(), q_ref.size(), q_found.begin());
    search_.solve(arm_, library::frame_of(*xr), {q_found.data(), q_ref.size()}, *tolerance);
    *residual = search_.residual();
    std::copy_n(q_found.begin(), q_ref.size(), q_ref.begin());
    return ok();
  }

 private:
  library::PoseSearch search_;
};

CHIMERA_COMPONENT(Ginvkin, "ginvkin", "Generalized inverse kinematics.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3; Nakamura and Hanafusa 1986");

}  // namespace
