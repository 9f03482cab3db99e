// SPDX-License-Identifier: Apache-2.0
// Rings the doorbell of a task behind a server, alone or in bursts.
#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct Ringer {
  InConst<Text<64>> target{"target", initial = "", doc = "The task whose doorbell is rung."};
  InConst<std::int64_t> every{"every", "1", range(1, 1e9), initial = 1, doc = "Cycles from one burst to the next."};
  InConst<std::int32_t> burst{"burst", "1", range(1, 16), initial = 1, doc = "Rings at once."};
  Out<std::int64_t> rung{"rung", "1", initial = 0, doc = "Rings so far."};

  Outcome init() {
    if (target->empty()) return fault("target is empty");
    if (*every < 1) return fault("every is at least 1");
    return *burst >= 1 && *burst <= 16 ? ok() : fault("burst is 1 to 16");
  }
  Outcome reinit() { return init(); }
  void on() { left_ = *every; }
  Outcome cycle(Cycle c) {
    if (--left_ > 0) return ok();
    left_ = *every;
    for (std::int32_t i = 0; i < *burst; ++i)
      if (!c.signal(Signal::kWakeup, target->c_str())) return fault("the target is no task behind a server");
    *rung += *burst;
    return ok();
  }

 private:
  std::int64_t left_ = 0;
};

CHIMERA_COMPONENT(Ringer, "ringer", "Rings the doorbell of a task behind a server.");

}  // namespace
