// SPDX-License-Identifier: Apache-2.0
// One force that drives and brakes: the direct-drive variant of the 2000 paper, section 6.
#include <algorithm>
#include <cmath>

#include "chimera/task/component.h"
#include "library/signals/input.h"

using namespace chimera;

namespace {

struct Motor {
  In<double> fd{"fd", "N", doc = "Wanted force; below 0 brakes."};
  Out<double> fm{"fm", "N", initial = 0.0, safety, range(-50000, 50000), doc = "Motor force at the wheels."};
  InConst<double> force_max{"force_max", "N", initial = 5000.0, range(0, 50000),
                            doc = "Limit of the motor, driving and braking."};

  Outcome init() { return *force_max >= 0 && *force_max <= 50000 ? ok() : fault("force_max is 0 to 50000 N"); }
  Outcome reinit() { return init(); }
  void on() {
    if (fm.is_outdated()) *fm = 0;
  }
  Outcome cycle(Cycle c) {
    if (!c.illegal() && !std::isfinite(*fd)) return library::unfit("fd is not finite", fd);
    *fm = c.illegal() ? 0 : std::clamp(*fd, -*force_max, *force_max);
    return ok();
  }
  void off() { *fm = 0; }
};

CHIMERA_COMPONENT(Motor, "motor", "Direct-drive motor that drives and brakes.", rate = 50.0,
                  source = "2000 paper, section 6");

}  // namespace
