// SPDX-License-Identifier: Apache-2.0
// Moves the tool on a figure of sines, in place of a person at the trackball.
#include <cmath>
#include <numbers>
#include <utility>

#include "chimera/base/math.h"
#include "library/kinematics/dh_ports.h"
#include "library/signals/fade.h"

using namespace chimera;

namespace {

struct Ctraj {
  Many<In<Pose>, 1> xm{"xm*", "1", frame = "base", doc = "Measured tool pose, for on; may be left out."};
  Out<Pose> xd{"xd", frame = "base", doc = "Desired tool pose."};
  InConst<Pose> centre{"centre", frame = "base", doc = "Middle of the figure, and the orientation of the tool."};
  InConst<double[3]> amplitude{"amplitude", "m", initial = 0.0, range(0, 10), frame = "base", doc = "Along each axis."};
  InConst<double[3]> frequency{"frequency", "Hz", initial = 0.0, range(0, 10), doc = "Along each axis."};
  InConst<double[3]> phase{"phase", "rad", initial = 0.0, doc = "Along each axis."};
  InConst<double> blend{"blend", "s", initial = 1.0, range(0, 3600),
                        doc = "Time in which the way from the start to the figure fades; 0: a jump."};

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
    stood_ = false;
    start(c, xd.is_handed_over());
  }
  // While the configuration is illegal, the arm holds itself, so the figure waits; then it starts where the tool is.
  void cycle(Cycle c) {
    if (c.illegal()) {
      stood_ = true;
      return;
    }
    if (std::exchange(stood_, false)) return start(c, false);
    fade_.advance(c.dt());
    go(static_cast<double>((c.now() - begin_).count) * 1e-9);
  }

 private:
  /// From a pose that is handed over, else from the measured one, else from the figure.
  void start(Cycle c, bool goes_on) {
    const bool is_measured = xm.size() > 0 && library::DhPorts::is_pose(*xm[0]);
    const bool has_start = (goes_on && library::DhPorts::is_pose(*xd)) || is_measured;
    const Pose from = goes_on && library::DhPorts::is_pose(*xd) ? *xd : is_measured ? *xm[0] : *centre;
    begin_ = c.now();
    fade_.start(0);
    go(0);
    if (!has_start) return;
    for (std::size_t i = 0; i < 3; ++i) away_[i] = from.position[i] - xd->position[i];
    std::copy_n(from.orientation, 4, first_);
    fade_.start(*blend);
    go(0);
  }
  void go(double t) {
    *xd = *centre;
    const double left = fade_.left();
    for (std::size_t i = 0; i < 3; ++i) {
      xd->position[i] += amplitude[i] * math::sin(2 * std::numbers::pi * frequency[i] * t + phase[i]);
      if (left > 0) xd->position[i] += left * away_[i];
    }
    const double turn = library::angle_between(first_, centre->orientation);
    if (left > 0) library::turn_towards(xd->orientation, first_, left * turn);
  }

  library::Fade fade_;
  double away_[3] = {}, first_[4] = {};  // at the start: the way from the figure (m), the orientation
  Nanoseconds begin_{};
  bool stood_ = false;  // the flag was up in the last cycle
};

CHIMERA_COMPONENT(Ctraj, "ctraj", "Cartesian trajectory of one application.", rate = 100.0,
                  source = "2000 paper, figure 3 e and f");

}  // namespace
