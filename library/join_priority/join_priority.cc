// SPDX-License-Identifier: Apache-2.0
// Selects the first live producer of one quantity. README.md is the data sheet.
#include <algorithm>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

struct JoinPriority {
  Many<In<double[]>> in{"in*", "U", "[n...<=64]", doc = "Producers, most important first."};
  InConst<double>    max_age{"max_age", "s", initial = 0.1, range(0, 86400),
                             doc = "Largest age of a value that counts; 0: any."};
  Out<double[]>      out{"out", "U", "[n...<=64]",
                         doc = "Values of the chosen input; hold without one."};
  Out<std::int32_t>  chosen{"chosen", "1", initial = -1, range(-1, 15), doc = "Number of the chosen input; -1: none."};

  Outcome init() const {
    if (in.size() == 0) return fault("there is nothing to join: name at least one input");
    if (!(*max_age >= 0)) return fault("max_age must be 0 s or more");
    return ok();
  }
  Outcome reinit() const { return init(); }
  void on() { cycle(); }
  void cycle() {
    const auto oldest = static_cast<std::int64_t>(std::min(*max_age, 86400.0) * 1e9);
    *chosen = -1;
    for (std::size_t i = 0; i < in.size() && *chosen < 0; ++i) {
      const auto& port = in[i];
      if (!port.valid() || (oldest > 0 && port.age().count > oldest) || !library::all_finite(port)) continue;
      std::copy(port.begin(), port.end(), out.begin());
      *chosen = static_cast<std::int32_t>(i);
    }
  }
};
CHIMERA_COMPONENT(JoinPriority, "join_priority",
                  "Joins several producers of one quantity: the first live one counts.",
                  source = "1994 paper, figure 3");
