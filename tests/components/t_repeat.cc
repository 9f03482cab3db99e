// SPDX-License-Identifier: Apache-2.0
// Repeated ports: as many as the description names, in and out.
#include "chimera/task/component.h"

using namespace chimera;

struct Repeat {
  Many<In<double>> in{"in*", "U"};
  Many<Out<double>, 4> out{"out*", "U", initial = 0.0, doc = "twice the input of the same number"};
  Out<std::int32_t> inputs{"inputs", "1", initial = 0};

  void cycle() {
    for (std::size_t i = 0; i < out.size(); ++i) *out[i] = i < in.size() ? 2 * *in[i] : -1;
    *inputs = static_cast<std::int32_t>(in.size());
  }
};
CHIMERA_COMPONENT(Repeat, "t_repeat", "Doubles each input.", rate = 1000.0);
