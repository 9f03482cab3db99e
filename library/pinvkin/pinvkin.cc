// SPDX-License-Identifier: Apache-2.0
// Inverse kinematics of the Puma 560 in closed form: the nearest of eight solutions.
#include "library/kinematics/dh_ports.h"
#include "library/kinematics/puma560.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Pinvkin {
  In<Pose> xr{"xr", frame = "base", doc = "Reference tool pose: the flange."};
  In<double[6]> q{"q", "rad", frame = "joint", doc = "Measured joint positions."};
  Out<double[6]> q_ref{"q_ref", "rad", initial = 0.0, frame = "joint", doc = "Joint positions for xr."};
  Out<bool> is_reachable{"is_reachable", "1", initial = true, doc = "False: xr is out of reach."};

  // Bumpless: continues from a command that is handed over, because the drives lag behind it; else starts at the
  // measured positions.
  Outcome on() {
    stood_ = false;
    return start(q_ref.is_handed_over());
  }
  // While the configuration is illegal, the arm holds itself, so q_ref waits; then it starts where the arm is.
  Outcome cycle(Cycle c) {
    if (c.illegal()) {
      stood_ = true;
      return ok();
    }
    if (stood_) {
      const Outcome started = start(false);
      stood_ = !library::is_ok(started);
      return started;
    }
    if (!library::DhPorts::is_pose(*xr)) return library::unfit("xr is not finite or no orientation", xr);
    library::Puma560::Vector near;
    std::copy_n(q_ref.begin(), 6, near.begin());
    *is_reachable = library::Puma560::nearest(library::frame_of(*xr), near, std::span<double, 6>(q_ref.begin(), 6));
    return ok();
  }
  bool error() { return true; }

 private:
  Outcome start(bool goes_on) {
    if (goes_on && library::all_finite(q_ref)) return ok();
    for (std::size_t i = 0; i < 6; ++i)
      if (!std::isfinite(q[i])) return fault("q is not finite: no solution is near");
    std::ranges::copy(q, q_ref.begin());
    return ok();
  }

  bool stood_ = false;  // the flag was up in the last cycle
};

CHIMERA_COMPONENT(Pinvkin, "pinvkin", "Puma inverse kinematics.", rate = 1000.0,
                  source = "2000 paper, table 1 and figure 3; Paul, Shimano and Mayer 1981");

}  // namespace
