// SPDX-License-Identifier: Apache-2.0
// Removes one frequency from a signal. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/signals/input.h"
#include "library/signals/tpt.h"

using namespace chimera;

namespace {

// Hz. Far below, rounding destroys the ratio of width and center.
constexpr double kLeast = 1e-6;

struct Notch {
  In<double[]>    x{"x", "U", "[n...<=64]", doc = "Any signal."};
  InConst<double> center{"center", "Hz", range(kLeast, 1e6), doc = "Frequency to remove; below half the rate."};
  InConst<double> width{"width", "Hz", range(kLeast, 1e6), doc = "Between the frequencies of gain 1/sqrt(2)."};
  Out<double[]>   y{"y", "U", "[n...<=64]", doc = "x without the centre frequency."};

  Outcome init() {
    if (!(*center >= kLeast && *width >= kLeast) || !math::is_finite(*center) || !math::is_finite(*width))
      return fault("center and width must be at least 1e-6 Hz");
    last_dt_ = 0;
    return ok();
  }
  Outcome reinit() { return init(); }
  Outcome on(Cycle c) {
    if (*center * c.dt() >= 0.5 || *width * c.dt() >= 0.5)
      return fault("center and width must be below half the rate of the task");
    is_settled_ = false;
    if (library::all_finite(x)) settle();
    return ok();
  }
  Outcome cycle(Cycle c) {
    const Outcome input = library::judge(x, "x");
    if (!library::is_ok(input)) return input;
    if (!is_settled_) settle();
    if (c.dt() != last_dt_) tune(c.dt());
    for (std::size_t i = 0; i < y.size(); ++i) y.begin()[i] = section_[i].notch(x.begin()[i], g_, k_);
    return ok();
  }
  bool error() { return true; }

 private:
  // The transform keeps the width exactly: tan(pi width dt) = k g / (1 + g^2).
  void tune(double dt) {
    last_dt_ = dt;
    g_ = library::prewarped(*center, dt);
    k_ = library::prewarped(*width, dt) * (1 + g_ * g_) / g_;
  }
  void settle() {
    for (std::size_t i = 0; i < y.size(); ++i) {
      section_[i].settle(x[i]);
      y[i] = x[i];
    }
    is_settled_ = true;
  }

  bool is_settled_ = false;
  double g_ = 0, k_ = 0, last_dt_ = 0;
  library::SecondOrder section_[library::kMostElements];
};

CHIMERA_COMPONENT(Notch, "notch", "Removes one frequency from a signal.", rate = 1000.0,
                  source = "Orfanidis 1996, section 11.3; Zavalishin 2018, section 4.4");

}  // namespace
