// SPDX-License-Identifier: Apache-2.0
// Moves the tool on a figure of sines, in place of a person at the trackball.
#include <cmath>
#include <numbers>

#include "library/kinematics/dh_ports.h"

using namespace chimera;

namespace {

struct Ctraj {
  Out<Pose> xd{"xd", frame = "base", doc = "Desired tool pose."};
  InConst<Pose> centre{"centre", frame = "base", doc = "Middle of the figure, and the orientation of the tool."};
  InConst<double[3]> amplitude{"amplitude", "m", initial = 0.0, range(0, 10), frame = "base", doc = "Along each axis."};
  InConst<double[3]> frequency{"frequency", "Hz", initial = 0.0, range(0, 10), doc = "Along each axis."};
  InConst<double[3]> phase{"phase", "rad", initial = 0.0, doc = "Along each axis."};

  void init() { reinit(); }
  void reinit() {
    if (!library::DhPorts::is_pose(*centre)) {
      throw std::runtime_error("centre: not finite, or the orientation is no unit quaternion");
    }
    for (const double angle : phase) {
      if (!std::isfinite(angle)) throw std::runtime_error("phase: a number is not finite");
    }
  }
  void on(Cycle c) {
    begin_ = c.now();
    go(0);
  }
  void cycle(Cycle c) { go(static_cast<double>((c.now() - begin_).count) * 1e-9); }

 private:
  void go(double t) {
    *xd = *centre;
    for (std::size_t i = 0; i < 3; ++i) {
      xd->position[i] += amplitude[i] * std::sin(2 * std::numbers::pi * frequency[i] * t + phase[i]);
    }
  }

  Nanoseconds begin_{};
};

CHIMERA_COMPONENT(Ctraj, "ctraj", "Cartesian trajectory of one application.", rate = 100.0,
                  source = "2000 paper, figure 3 e and f");

}  // namespace
