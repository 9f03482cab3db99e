// SPDX-License-Identifier: Apache-2.0
// A tool on the flange of an arm: provides its frame and mass as constants.
#include <cmath>

#include "library/kinematics/dh_ports.h"

using namespace chimera;

namespace {

struct Tool {
  Out<bool> is_attached{"is_attached", "1", initial = false, doc = "The task is ON."};
  InConst<Pose> pose{"pose", frame = "last", doc = "The tool in the frame of the flange."};
  InConst<double> mass{"mass", "kg", initial = 0.0, range(0, 100), doc = "Mass of the tool with its load."};
  OutConst<Pose> tool{"tool", frame = "last", doc = "`pose`."};
  OutConst<double> payload_mass{"payload_mass", "kg", doc = "`mass`."};

  Outcome init() {
    if (!library::DhPorts::is_pose(*pose)) return fault("pose: not finite, or the orientation is no unit quaternion");
    if (!(*mass >= 0 && *mass <= 100)) return fault("mass is 0 to 100 kg");
    *tool = *pose;
    *payload_mass = *mass;
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() { *is_attached = true; }
  void cycle(Cycle) { *is_attached = true; }
  void off() { *is_attached = false; }
};

CHIMERA_COMPONENT(Tool, "tool", "Provides the frame and the mass of the tool on the flange.", rate = 10.0,
                  source = "1994 paper, section 3.3, the exchange of a tool");

}  // namespace
