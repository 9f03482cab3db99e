// SPDX-License-Identifier: Apache-2.0
// Cartesian trajectory interpolator: moves the reference towards the desired pose within speed limits.
#include "library/kinematics/dh_ports.h"

using namespace chimera;

namespace {

struct Cinterp {
  In<Pose> xd{"xd", frame = "base", doc = "Desired tool pose, at any rate."};
  In<Pose> xm{"xm", frame = "base", doc = "Measured tool pose."};
  Out<Pose> xr{"xr", frame = "base", doc = "Reference tool pose."};
  InConst<double> gain{"gain", "1/s", initial = 10.0, range(0, 100), doc = "Rate at which xr approaches xd."};
  InConst<double> speed_limit{"speed_limit", "m/s", initial = 0.5, range(0, 10), doc = "Largest speed of xr."};
  InConst<double> turn_limit{"turn_limit", "rad/s", initial = 1.0, range(0, 10), doc = "Largest turning speed of xr."};
  InConst<double> leash{"leash", "m", initial = 0.1, range(1e-3, 10), doc = "Largest distance from xm to xr."};

  // Bumpless: continues from a reference that is handed over, else starts at the measured pose.
  Outcome on() {
    if (xr.is_handed_over() && library::DhPorts::is_pose(*xr)) return ok();
    if (!library::DhPorts::is_pose(*xm)) return fault("xm is not finite or no orientation: xr cannot begin there");
    *xr = *xm;
    return ok();
  }
  Outcome cycle(Cycle c) {
    if (c.illegal()) return ok();
    if (!library::DhPorts::is_pose(*xd) || !library::DhPorts::is_pose(*xm)) {
      return fault("a pose is not finite, or has no orientation");
    }
    const library::Vec3 way = place(*xd) - place(*xr);
    const double distance = library::length(way), step = std::min(*gain * distance, *speed_limit) * c.dt();
    library::Vec3 next = place(*xr) + (distance > 0 ? step / distance : 0) * way;
    const library::Vec3 ahead = next - place(*xm);
    if (library::length(ahead) > *leash) next = place(*xm) + (*leash / library::length(ahead)) * ahead;
    std::copy_n(next.at, 3, xr->position);
    const double angle = library::angle_between(xr->orientation, xd->orientation);
    library::turn_towards(xr->orientation, xd->orientation, std::min(*gain * angle, *turn_limit) * c.dt());
    return ok();
  }

 private:
  static library::Vec3 place(const Pose& pose) { return {pose.position[0], pose.position[1], pose.position[2]}; }
};

CHIMERA_COMPONENT(Cinterp, "cinterp", "Cartesian trajectory interpolator.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3");

}  // namespace
