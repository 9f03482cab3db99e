// SPDX-License-Identifier: Apache-2.0
// The weighted sum of several signals. README.md is the data sheet.
#include <algorithm>

#include "chimera/base/fixed.h"
#include "chimera/base/message.h"
#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Sum {
  Many<In<double[]>> in{"in*", "U", "[n...<=64]", doc = "Signals to add."};
  Many<InConst<double>> weight{"weight*", "1", initial = 1.0, doc = "Weight of each input; one for each, or none."};
  InConst<double[]> bias{"bias", "U", "[n...<=64]", initial = 0.0, doc = "Constant to add."};
  Out<double[]> out{"out", "U", "[n...<=64]", doc = "The sum."};

  Outcome init() const {
    if (in.size() == 0) return fault("there is nothing to add: name at least one input");
    if (weight.size() != 0 && weight.size() != in.size()) return fault("give one weight for each input, or none");
    for (const auto& one : weight)
      if (!math::is_finite(*one)) return fault("weights must be finite");
    return library::all_finite(bias) ? ok() : fault("bias must be finite");
  }
  Outcome reinit() const { return init(); }
  void on() {
    if (std::ranges::all_of(in, [](const auto& port) { return library::all_finite(port); })) add();
  }
  Outcome cycle() {
    for (std::size_t i = 0; i < in.size(); ++i)
      if (!library::all_finite(in[i])) return judge(i);
    add();
    return ok();
  }
  bool error() { return true; }

 private:
  // Formats a name, but only for a fault.
  Outcome judge(std::size_t i) const {
    return library::judge(in[i], FixedString<8>((Message("in[") << i << "]").view()).c_str());
  }
  void add() {
    std::copy(bias.begin(), bias.end(), out.begin());
    for (std::size_t k = 0; k < in.size(); ++k) {
      const double factor = weight.size() == 0 ? 1.0 : *weight[k];
      const double* from = in[k].begin();
      for (double& to : out) to += factor * *from++;
    }
  }
};

CHIMERA_COMPONENT(Sum, "sum", "The weighted sum of several signals.");

}  // namespace
