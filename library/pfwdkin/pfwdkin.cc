// SPDX-License-Identifier: Apache-2.0
// Forward kinematics of the Puma 560 in closed form.
#include "library/kinematics/dh_ports.h"
#include "library/kinematics/puma560.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Pfwdkin {
  In<double[6]> q{"q", "rad", frame = "joint", doc = "Measured joint positions."};
  Out<Pose> xm{"xm", frame = "base", doc = "Measured tool pose: the flange."};

  Outcome on() { return library::required(cycle(), "q is not finite"); }
  Outcome cycle() {
    const library::Frame flange = library::Puma560::forward(std::span<const double, 6>(q.begin(), 6));
    if (!std::isfinite(library::length(flange.origin) + library::length(flange.x)))
      return library::unfit("q is not finite", q);
    *xm = library::pose_of(flange);
    return ok();
  }
  bool error() { return true; }
};

CHIMERA_COMPONENT(Pfwdkin, "pfwdkin", "Puma forward kinematics.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3");

}  // namespace
