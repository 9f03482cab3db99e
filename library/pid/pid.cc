// SPDX-License-Identifier: Apache-2.0
// PID controller of any quantity with any actuator. README.md is the data sheet.
#include <algorithm>

#include "chimera/task/component.h"
#include "library/pid/pid_axis.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Pid {
  In<double[]> reference{"reference", "U", "[n...<=64]", doc = "Wanted value."};
  In<double[]> measured{"measured", "U", "[n...<=64]", doc = "Measured value."};
  In<double[]> kp{"kp", "X/U", "[n...<=64]", doc = "Gain of the error."};
  In<double[]> ki{"ki", "X/(U.s)", "[n...<=64]", initial = 0.0, doc = "Gain of its integral."};
  In<double[]> kd{"kd", "X.s/U", "[n...<=64]", initial = 0.0, doc = "Gain of its rate of change."};
  InConst<double[]> low{"low", "X", "[n...<=64]", doc = "Least output."};
  InConst<double[]> high{"high", "X", "[n...<=64]", at_least = "low", doc = "Greatest output."};
  InConst<double> filter_time{"filter_time", "s", initial = 0.0, range(0, 86400),
                              doc = "Time constant of the filter of both rates; 0 for none."};
  InConst<double> reference_weight{"reference_weight", "1", initial = 1.0, range(0, 1),
                                   doc = "b: share of the reference in P; below 1: less overshoot."};
  InConst<double> derivative_weight{"derivative_weight", "1", initial = 0.0, range(0, 1),
                                    doc = "c: share of the reference in D; 0: no kick at a step."};
  InConst<double[]> deadband{"deadband",
                             "U",
                             "[n...<=64]",
                             initial = 0.0,
                             range(0, library::kNoLimit),
                             doc = "An error up to this counts as 0."};
  InConst<double[]> ff{"ff", "X/U", "[n...<=64]", initial = 0.0, doc = "Feed-forward of the reference."};
  InConst<double[]> ff_rate{"ff_rate", "X.s/U", "[n...<=64]", initial = 0.0,
                            doc = "Feed-forward of its rate of change."};
  InConst<bool> holds_off{"holds_off", "1", initial = true,
                          doc = "off holds the output; false: it becomes 0, or the limit next to 0."};
  Out<double[]> output{"output", "X", "[n...<=64]", initial = 0.0, safety, doc = "Output, low to high."};

  Outcome init() {
    for (std::size_t i = 0; i < low.size(); ++i)
      if (!(low[i] <= high[i])) return fault("low must be at most high");
    if (!(*filter_time >= 0 && *filter_time <= 86400)) return fault("filter_time must be 0 to 86400 s");
    if (!is_share(*reference_weight) || !is_share(*derivative_weight))
      return fault("reference_weight and derivative_weight must be 0 to 1");
    if (!std::ranges::all_of(deadband, [](double width) { return width >= 0; }))
      return fault("deadband must be 0 or more");
    if (!library::all_finite(ff) || !library::all_finite(ff_rate)) return fault("ff and ff_rate must be finite");
    return ok();
  }
  Outcome reinit() { return init(); }

  // The first cycle starts the loop, because the task of an input may go ON after this one. An outdated output belongs
  // to another state of the plant.
  void on() {
    is_started_ = false;
    if (output.is_outdated()) rest();
  }

  Outcome cycle(Cycle c) {
    if (c.illegal()) {  // the actuator holds itself, so the error must not be integrated
      is_started_ = false;
      return ok();
    }
    const Outcome inputs = judge_all();
    if (!library::is_ok(inputs)) return inputs;
    if (!is_started_) start();
    for (std::size_t i = 0; i < output.size(); ++i) {
      const double u = step(i, c.dt());
      if (!math::is_finite(u)) {
        is_started_ = false;
        return fault("the output is not finite: the gains or the inputs are too large");
      }
      output.begin()[i] = u;
    }
    return ok();
  }
  bool error() { return true; }
  void off() {
    if (!*holds_off) rest();
  }

 private:
  struct Loop {
    library::PidAxis axis;
    double last_weighted = 0, last_reference = 0, reference_rate = 0;
  };
  /// Terms of the control law at one instant.
  struct Terms {
    library::PidGains gains;
    double error, weighted, besides;  // besides: feed-forward and weighted reference
  };

  void rest() {
    for (std::size_t i = 0; i < output.size(); ++i) output[i] = std::clamp(0.0, low[i], high[i]);
  }
  static bool is_share(double value) { return value >= 0 && value <= 1; }
  Outcome judge_all() {
    Outcome found = library::judge(measured, "measured");
    if (library::is_ok(found)) found = library::judge(reference, "reference");
    if (library::is_ok(found)) found = library::judge(kp, "kp");
    if (library::is_ok(found)) found = library::judge(ki, "ki");
    if (library::is_ok(found)) found = library::judge(kd, "kd");
    return found;
  }
  Terms terms(std::size_t i) const {
    const double r = reference.begin()[i], y = measured.begin()[i], band = deadband.begin()[i];
    const double p = kp.begin()[i];
    return {{p, ki.begin()[i], kd.begin()[i]},
            r - y - std::clamp(r - y, -band, band),
            *derivative_weight * r - y,
            (*reference_weight - 1) * p * r + ff.begin()[i] * r};
  }
  // Bumpless: sets the integral so that the output continues from the last one: that of a predecessor, the one held
  // while the configuration was illegal, or the initial one.
  void start() {
    for (std::size_t i = 0; i < output.size(); ++i) {
      const Terms now = terms(i);
      loop_[i].axis.start(now.gains, now.error, 0, std::clamp(output[i], low[i], high[i]) - now.besides);
      loop_[i].last_weighted = now.weighted;
      loop_[i].last_reference = reference[i];
      loop_[i].reference_rate = 0;
    }
    is_started_ = true;
  }
  double step(std::size_t i, double dt) {
    Loop& loop = loop_[i];
    const Terms now = terms(i);
    const double rate = (now.weighted - loop.last_weighted) / dt;
    const double reference_rate = (reference.begin()[i] - loop.last_reference) / dt;
    loop.reference_rate += (reference_rate - loop.reference_rate) * dt / (*filter_time + dt);
    loop.last_weighted = now.weighted;
    loop.last_reference = reference.begin()[i];
    const double besides = now.besides + ff_rate.begin()[i] * loop.reference_rate;
    const double least = low.begin()[i], most = high.begin()[i];
    const double u = loop.axis.step(now.gains, now.error, rate, dt, *filter_time, least - besides, most - besides);
    return std::clamp(u + besides, least, most);  // rounding of the sum may cross a limit
  }

  Loop loop_[library::kMostElements];
  bool is_started_ = false;
};

CHIMERA_COMPONENT(Pid, "pid", "PID controller of any quantity, with anti-windup, feed-forward and filtered derivative.",
                  rate = 1000.0, source = "Astrom and Hagglund 2006, sections 3.4 and 3.5");

}  // namespace
