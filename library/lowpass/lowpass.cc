// SPDX-License-Identifier: Apache-2.0
// Butterworth low-pass filter of order 1 to 8 by the bilinear transform with prewarping. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/signals/input.h"
#include "library/signals/tpt.h"

using namespace chimera;

namespace {

constexpr std::int32_t kMostOrder = 8;

struct Lowpass {
  In<double[]>          x{"x", "U", "[n...<=64]", doc = "Any signal."};
  InConst<double>       cutoff{"cutoff", "Hz", range(0, 1e6),
                               doc = "Frequency of gain 1/sqrt(2); above 0, below half the rate."};
  InConst<std::int32_t> order{"order", "1", initial = 2, range(1, kMostOrder), doc = "Order of the filter."};
  Out<double[]>         y{"y", "U", "[n...<=64]", doc = "x below the cutoff."};

  Outcome init() {
    if (!(*cutoff > 0) || !math::is_finite(*cutoff)) return fault("cutoff must be above 0 Hz");
    if (*order < 1 || *order > kMostOrder) return fault("order must be 1 to 8");
    pairs_ = static_cast<std::size_t>(*order) / 2;
    is_odd_ = *order % 2 == 1;
    // The poles of the Butterworth circle: s^2 + 2 sin((2 m + 1) pi / (2 order)) s + 1.
    for (std::size_t m = 0; m < pairs_; ++m)
      k_[m] = 2 * math::sin(static_cast<double>(2 * m + 1) * math::kPi / (2 * *order));
    last_dt_ = 0;
    return ok();
  }
  Outcome reinit() { return init(); }
  Outcome on(Cycle c) {
    if (*cutoff * c.dt() >= 0.5) return fault("cutoff must be below half the rate of the task");
    is_settled_ = false;
    if (library::all_finite(x)) settle();
    return ok();
  }
  Outcome cycle(Cycle c) {
    const Outcome input = library::judge(x, "x");
    if (!library::is_ok(input)) return input;
    if (!is_settled_) settle();
    if (c.dt() != last_dt_) {  // the first cycle, or the first after dropped releases
      last_dt_ = c.dt();
      g_ = library::prewarped(*cutoff, last_dt_);
    }
    for (std::size_t i = 0; i < y.size(); ++i) {
      double value = x.begin()[i];
      if (is_odd_) value = first_[i].lowpass(value, g_);
      for (std::size_t m = 0; m < pairs_; ++m) value = second_[i][m].lowpass(value, g_, k_[m]);
      y.begin()[i] = value;
    }
    return ok();
  }
  bool error() { return true; }

 private:
  // Sets the state for a constant input, so that there is no transient.
  void settle() {
    for (std::size_t i = 0; i < y.size(); ++i) {
      first_[i].settle(x[i]);
      for (auto& section : second_[i]) section.settle(x[i]);
      y[i] = x[i];
    }
    is_settled_ = true;
  }

  std::size_t pairs_ = 0;
  bool is_odd_ = false, is_settled_ = false;
  double k_[kMostOrder / 2] = {};
  double g_ = 0, last_dt_ = 0;
  library::FirstOrder first_[library::kMostElements];
  library::SecondOrder second_[library::kMostElements][kMostOrder / 2];
};

CHIMERA_COMPONENT(Lowpass, "lowpass", "Butterworth low-pass filter of order 1 to 8.", rate = 1000.0,
                  source = "Oppenheim and Schafer 2010, section 7.2; Zavalishin 2018, section 4.4");

}  // namespace
