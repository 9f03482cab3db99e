// SPDX-License-Identifier: Apache-2.0
// Compares a signal with a level or a band, with hysteresis. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Comparator {
  In<double[]> x{"x", "U", "[n...<=64]", doc = "Any signal."};
  In<double[]> level{"level", "U", "[n...<=64]", doc = "Level to compare with."};
  InConst<Text<16>> when{"when", "1", initial = "above", doc = "above, below, inside or outside."};
  InConst<double[]> width{"width",
                          "U",
                          "[n...<=64]",
                          initial = 0.0,
                          range(0, library::kNoLimit),
                          doc = "Half width of the band."};
  InConst<double[]> hysteresis{"hysteresis",
                               "U",
                               "[n...<=64]",
                               initial = 0.0,
                               range(0, library::kNoLimit),
                               doc = "Distance between the thresholds of true and false."};
  Out<bool[]> y{"y", "1", "[n...<=64]", initial = false, doc = "Result."};

  Outcome init() {
    if (*when == "above")
      relation_ = Relation::kAbove;
    else if (*when == "below")
      relation_ = Relation::kBelow;
    else if (*when == "inside")
      relation_ = Relation::kInside;
    else if (*when == "outside")
      relation_ = Relation::kOutside;
    else
      return fault("when must be above, below, inside or outside");
    const bool has_band = relation_ == Relation::kInside || relation_ == Relation::kOutside;
    for (std::size_t i = 0; i < width.size(); ++i) {
      if (!is_amount(width[i]) || !is_amount(hysteresis[i])) return fault("width and hysteresis must be 0 or more");
      if (has_band && !(width[i] > 0)) return fault("a band has a width above 0");
      if (has_band && hysteresis[i] > 2 * width[i]) return fault("hysteresis must be at most twice the width");
    }
    return ok();
  }
  Outcome reinit() { return init(); }
  // Between the thresholds y keeps its last value.
  void on() {
    if (library::all_finite(x) && library::all_finite(level)) compare();
  }
  Outcome cycle() {
    Outcome inputs = library::judge(x, "x");
    if (library::is_ok(inputs)) inputs = library::judge(level, "level");
    if (library::is_ok(inputs)) compare();
    return inputs;
  }
  bool error() { return true; }

 private:
  enum class Relation { kAbove, kBelow, kInside, kOutside };

  static bool is_amount(double value) { return value >= 0 && math::is_finite(value); }
  /// Distance of the signal beyond the threshold.
  double beyond(std::size_t i) const {
    const double apart = x.begin()[i] - level.begin()[i];
    if (relation_ == Relation::kAbove) return apart;
    if (relation_ == Relation::kBelow) return -apart;
    return math::fabs(apart) - width.begin()[i];
  }
  void compare() {
    const bool is_turned = relation_ == Relation::kInside;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double distance = beyond(i), half = hysteresis.begin()[i] / 2;
      bool& is_so = y.begin()[i];
      if (distance > half)
        is_so = !is_turned;
      else if (distance <= -half)
        is_so = is_turned;
    }
  }

  Relation relation_ = Relation::kAbove;
};

CHIMERA_COMPONENT(Comparator, "comparator", "Compares a signal with a level or a band, with hysteresis.");

}  // namespace
