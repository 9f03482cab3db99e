// SPDX-License-Identifier: Apache-2.0
// The join connector of the 1994 paper (figure 3): weighted mean of several producers of one quantity. README.md is the
// data sheet.
#include "chimera/task/component.h"

using namespace chimera;

struct JoinMean {
  Many<In<double>>      in{"in*", "U", doc = "Values to average."};
  Many<InConst<double>> weight{"weight*", "1", initial = 1.0, range(0, 1e6), doc = "Weight of each input."};
  Out<double>           out{"out", "U", doc = "Weighted mean of the valid inputs."};

  Outcome init() const {
    if (in.size() == 0) return fault("there is nothing to join: name at least one input");
    if (weight.size() != 0 && weight.size() != in.size()) return fault("give one weight for each input, or none");
    return ok();
  }
  void on() { cycle(); }
  void cycle() {
    double sum = 0, weights = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      if (!in[i].valid()) continue;
      const double w = weight.size() == 0 ? 1.0 : *weight[i];
      sum += w * *in[i];
      weights += w;
    }
    if (weights > 0) *out = sum / weights;  // otherwise the last mean holds
  }
};
CHIMERA_COMPONENT(JoinMean, "join_mean", "Joins several producers of one quantity by their weighted mean.",
                  source = "1994 paper, figure 3");
