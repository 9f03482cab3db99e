// SPDX-License-Identifier: Apache-2.0
// A curve through given points, straight between them. README.md is the data sheet.
#include <algorithm>

#include "chimera/base/message.h"
#include "chimera/base/number_text.h"
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct LookupTable {
  In<double[]> x{"x", "U", "[n...<=64]", doc = "Any signal."};
  InConst<double[]> at{"at", "U", "[points<=256]", doc = "x of the points, increasing."};
  InConst<double[]> value{"value", "X", "[points<=256]", doc = "y of the points."};
  InConst<Text<16>> outside{"outside", "1", initial = "hold", doc = "Outside the points: hold, extend or fault."};
  Out<double[]> y{"y", "X", "[n...<=64]", doc = "The curve at x."};

  Outcome init() {
    if (*outside == "hold")
      outside_ = Outside::kHold;
    else if (*outside == "extend")
      outside_ = Outside::kExtend;
    else if (*outside == "fault")
      outside_ = Outside::kFault;
    else
      return fault("outside must be hold, extend or fault");
    if (at.size() < 2) return fault("a table has two points or more");
    if (!library::all_finite(at) || !library::all_finite(value)) return fault("at and value must be finite");
    for (std::size_t k = 1; k < at.size(); ++k) {
      if (at[k] > at[k - 1]) continue;
      return fault((Message("at[") << k << "] is " << number_text(at[k], 9).view() << ", after "
                                   << number_text(at[k - 1], 9).view()
                                   << ": each point of at must be above the one before").view());
    }
    return ok();
  }
  Outcome reinit() { return init(); }
  void on() {
    if (library::all_finite(x) && !first_outside()) look_up();
  }
  Outcome cycle() {
    const Outcome input = library::judge(x, "x");
    if (!library::is_ok(input)) return input;
    if (const double* beyond = first_outside())
      return fault((Message("x is ") << number_text(*beyond, 9).view() << ", and the table goes from "
                                     << number_text(at[0], 9).view() << " to "
                                     << number_text(at[at.size() - 1], 9).view()).view());
    look_up();
    return ok();
  }
  bool error() { return true; }

 private:
  enum class Outside { kHold, kExtend, kFault };

  const double* first_outside() const {
    if (outside_ != Outside::kFault) return nullptr;
    const double least = at.begin()[0], most = at.begin()[at.size() - 1];
    const double* found = std::find_if(x.begin(), x.end(), [&](double v) { return v < least || v > most; });
    return found == x.end() ? nullptr : found;
  }
  void look_up() {
    const double* in = x.begin();
    for (double& out : y) out = curve(*in++);
  }
  double curve(double x_now) const {
    const double *first = at.begin(), *last = at.end() - 1;
    if (outside_ == Outside::kHold) x_now = std::clamp(x_now, *first, *last);
    // The segment whose end is the first inner point above x, otherwise the last segment.
    const double* end = std::upper_bound(first + 1, last, x_now);
    const double *y_end = value.begin() + (end - first), x0 = end[-1], y0 = y_end[-1];
    // Weighted mean of both ends, so that the curve is exact at the points.
    const double share = (x_now - x0) / (*end - x0);
    return y0 * (1 - share) + *y_end * share;
  }

  Outside outside_ = Outside::kHold;
};

CHIMERA_COMPONENT(LookupTable, "lookup_table", "A curve through given points, straight between them.");

}  // namespace
