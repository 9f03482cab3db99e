// SPDX-License-Identifier: Apache-2.0
// Provides the constants of a robot from its URDF file, for generic kinematics and for limits.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "chimera/task/component.h"
#include "library/model_text/urdf_chain.h"

using namespace chimera;

namespace {

struct UrdfModel {
  OutConst<std::int32_t> ndof{"ndof", "1", doc = "Joints that turn, root to tip."};
  OutConst<library::DhLink[]> dh{"dh", "1", "[ndof<=10]", doc = "Denavit-Hartenberg rows, root to tip."};
  OutConst<Pose> base{"base", "1", frame = "base", doc = "Frame 0 in the frame of the root link."};
  OutConst<Pose> tool{"tool", "1", frame = "last", doc = "Frame of the tip in frame ndof."};
  OutConst<double[]> q_min{"q_min", "rad", "[ndof<=10]", frame = "joint", doc = "Lower joint limits; -1e6 for none."};
  OutConst<double[]> q_max{"q_max", "rad", "[ndof<=10]", frame = "joint", doc = "Upper joint limits; 1e6 for none."};
  OutConst<double[]> qd_max{"qd_max", "rad/s", "[ndof<=10]", frame = "joint", doc = "Joint speeds; 1e6 for no limit."};
  OutConst<double[]> tau_max{"tau_max", "N.m", "[ndof<=10]", frame = "joint",
                             doc = "Torques (the file's effort); 1e6 for no limit."};
  OutConst<bool[]> is_continuous{"is_continuous", "1", "[ndof<=10]", doc = "The joint turns without end."};
  InConst<Text<64>> tip{"tip", "1", initial = "", doc = "Link that is the tool; empty: behind the most joints."};
  Resource model{"model", safe_state, shared, doc = "URDF file."};

  void init(Cycle c) { read(c); }
  void reinit(Cycle c) { read(c); }
  void cycle() {}  // init has written all outputs

 private:
  void read(Cycle c) {
    const Result<library::UrdfChain> found = library::read_urdf(model.c_str(), tip->c_str());
    if (!found) throw std::runtime_error(std::string(found.error().message.view()));
    const std::size_t n = found->chain.ndof;
    *ndof = static_cast<std::int32_t>(n);
    std::copy_n(found->chain.dh.begin(), n, dh.begin());
    *base = found->chain.base;
    *tool = found->chain.tool;
    std::copy_n(found->low.begin(), n, q_min.begin());
    std::copy_n(found->high.begin(), n, q_max.begin());
    std::copy_n(found->speed.begin(), n, qd_max.begin());
    std::copy_n(found->effort.begin(), n, tau_max.begin());
    std::copy_n(found->is_continuous.begin(), n, is_continuous.begin());
    if (!found->note.empty()) c.note(found->note.c_str());
  }
};

CHIMERA_COMPONENT(UrdfModel, "urdf_model", "Constants of a robot from its URDF file.", rate = 1.0,
                  source = "2000 paper, section 3.2: constants of the robot itself");

}  // namespace
