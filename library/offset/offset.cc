// SPDX-License-Identifier: Apache-2.0
// Adds a variable offset: y = x + offset. README.md is the data sheet.
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Offset {
  In<double[]> x{"x", "U", "[n...<=64]", doc = "Any signal."};
  In<double[]> offset{"offset", "U", "[n...<=64]", doc = "Value to add."};
  Out<double[]> y{"y", "U", "[n...<=64]", doc = "x plus the offset."};

  void on() {
    if (library::all_finite(x) && library::all_finite(offset)) add();
  }
  Outcome cycle() {
    Outcome inputs = library::judge(x, "x");
    if (library::is_ok(inputs)) inputs = library::judge(offset, "offset");
    if (library::is_ok(inputs)) add();
    return inputs;
  }
  bool error() { return true; }

 private:
  void add() {
    const double *in = x.begin(), *more = offset.begin();
    for (double& out : y) out = *in++ + *more++;
  }
};

CHIMERA_COMPONENT(Offset, "offset", "Adds an offset that may change while it runs.");

}  // namespace
