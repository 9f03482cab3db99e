// SPDX-License-Identifier: Apache-2.0
// Counts its cycles until it fails on purpose, to show how other tasks react. README.md is the data sheet.
#include <limits>
#include <stdexcept>

#include "chimera/task/component.h"

using namespace chimera;

namespace {

constexpr double kNeverSeconds = 1e9;

struct Faulty {
  Out<double> y{"y", "1", initial = 0.0, safety, range(0, 1e12), doc = "Cycles since on."};
  InConst<double> throw_after{"throw_after", "s", initial = kNeverSeconds, range(0, 1e9),
                              doc = "Time after which every cycle throws an exception."};
  InConst<double> nan_after{"nan_after", "s", initial = kNeverSeconds, range(0, 1e9),
                            doc = "Time after which every cycle writes NaN to y."};

  void on(Cycle c) {
    from_ = c.now();
    *y = 0;
  }
  void cycle(Cycle c) {
    const double age = static_cast<double>((c.now() - from_).count) * 1e-9;
    *y += 1;
    if (age >= *nan_after) *y = std::numeric_limits<double>::quiet_NaN();
    if (age >= *throw_after) throw std::runtime_error("thrown on purpose");
  }
  bool clear() const { return true; }

 private:
  Nanoseconds from_;
};

CHIMERA_COMPONENT(Faulty, "faulty", "Counts its cycles until it fails on purpose.");

}  // namespace
