// SPDX-License-Identifier: Apache-2.0
// Generalized forward kinematics: tool pose of any serial arm.
#include "library/kinematics/dh_ports.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Gfwdkin : library::DhPorts {
  In<double[]> q{"q", "rad", "[ndof<=10]", frame = "joint", doc = "Measured joint positions."};
  Out<Pose> xm{"xm", frame = "base", doc = "Measured tool pose."};

  void init() { read_chain(); }
  void reinit() { read_chain(); }
  Outcome on() { return library::required(cycle(), "q is not finite"); }
  Outcome cycle() {
    const library::Frame found = arm_.tool_frame(q.span());
    if (!std::isfinite(library::length(found.origin) + library::length(found.x)))
      return library::unfit("q is not finite", q);
    *xm = library::pose_of(found);
    return ok();
  }
  bool error() { return true; }
};

CHIMERA_COMPONENT(Gfwdkin, "gfwdkin", "Generalized forward kinematics.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3");

}  // namespace
