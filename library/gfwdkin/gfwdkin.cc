// SPDX-License-Identifier: Apache-2.0
// Generalized forward kinematics: tool pose of any serial arm.
#include "library/kinematics/dh_ports.h"

using namespace chimera;

namespace {

struct Gfwdkin : library::DhPorts {
  In<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured joint positions."};
  Out<Pose> xm{"xm", frame = "base", doc = "Measured tool pose."};

  void init() { read_chain(); }
  void reinit() { read_chain(); }
  Outcome on() { return cycle(); }
  Outcome cycle() {
    const library::Frame found = arm_.tool_frame(q.span());
    if (!std::isfinite(library::length(found.origin) + library::length(found.x))) return fault("q is not finite");
    *xm = library::pose_of(found);
    return ok();
  }
};

CHIMERA_COMPONENT(Gfwdkin, "gfwdkin", "Generalized forward kinematics.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3");

}  // namespace
