// SPDX-License-Identifier: Apache-2.0
// Uses from none to three times of its budget, and checks the number of dropped releases that its cycle receives.
#include <cmath>

#include "chimera/task/component.h"

using namespace chimera;

struct Overrun {
  InConst<std::int64_t> allowed{"allowed", "ns", initial = 0, doc = "its budget"};
  InConst<double> period{"period", "s", initial = 0.001};
  Out<std::int64_t> bursts{"bursts", "1", initial = 0, doc = "cycles less than a period after the one before"};
  Out<std::int64_t> unsaid{"unsaid", "1", initial = 0, doc = "cycles told of other losses than dt shows"};
  Out<std::int64_t> over{"over", "1", initial = 0, doc = "cycles that used more than allowed"};

  void cycle(Cycle c) {
    const double periods = c.dt() / *period;
    if (periods < 0.999) ++*bursts;
    if (c.count() > 0 && std::lround(periods) - 1 != static_cast<long>(c.dropped())) ++*unsaid;
    random_ = random_ * 1664525u + 1013904223u;
    const std::int64_t time = static_cast<std::int64_t>(random_ >> 8) % (3 * *allowed + 1);
    c.spend({time});
    if (time > *allowed) ++*over;
  }
  std::uint32_t random_ = 1;
};
CHIMERA_COMPONENT(Overrun, "t_overrun", "Uses up to three times its budget.", rate = 1000.0);
