// SPDX-License-Identifier: Apache-2.0
// Cartesian trajectory interpolator: moves the reference towards the desired pose within speed limits.
#include "library/kinematics/dh_ports.h"
#include "library/signals/input.h"

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
  Outcome on(Cycle c) {
    stood_ = false;
    return start(c, xr.is_handed_over());
  }
  // While the configuration is illegal, the arm holds itself, so xr waits; then it starts where the tool is.
  Outcome cycle(Cycle c) {
    if (c.illegal()) {
      stood_ = true;
      return ok();
    }
    if (stood_) {
      const Outcome started = start(c, false);
      stood_ = !library::is_ok(started);
      return started;
    }
    if (!library::DhPorts::is_pose(*xd) || !library::DhPorts::is_pose(*xm)) {
      return library::unfit("a pose is not finite, or has no orientation", xd, xm);
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
  bool error() { return true; }

 private:
  Outcome start(Cycle c, bool goes_on) {
    const bool is_measured = library::DhPorts::is_pose(*xm);
    if (goes_on && library::DhPorts::is_pose(*xr)) {
      const bool is_beyond = is_measured && library::length(place(*xr) - place(*xm)) > *leash;
      if (is_beyond) c.note("xr is taken over farther from xm than leash: the first cycle brings it back");
      return ok();
    }
    if (!is_measured) return fault("xm is not finite or no orientation: xr cannot begin there");
    *xr = *xm;
    return ok();
  }
  static library::Vec3 place(const Pose& pose) { return {pose.position[0], pose.position[1], pose.position[2]}; }

  bool stood_ = false;  // the flag was up in the last cycle
};

CHIMERA_COMPONENT(Cinterp, "cinterp", "Cartesian trajectory interpolator.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3");

}  // namespace
