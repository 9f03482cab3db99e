// SPDX-License-Identifier: Apache-2.0
// A signal to test others with: a ramp, or the expiry of the own job.
#include "chimera/task/component.h"

using namespace chimera;

struct Source {
  InConst<double> start{"start", "U", initial = 0.0};
  InConst<double> slope{"slope", "U/s", initial = 1.0};
  InConst<std::int64_t> spend{"spend", "ns", initial = 0, doc = "execution time of each cycle"};
  Out<double> x{"x", "U", doc = "start + slope t, t from on; never written before the first cycle"};
  Out<bool> expired{"expired", initial = false, doc = "the job was past its deadline after spending"};

  void on(Cycle) { t_ = 0; }
  void cycle(Cycle c) {
    t_ += c.dt();
    *x = *start + *slope * t_;
    if (*spend > 0) c.spend({*spend});
    *expired = c.expired();
  }
  double t_ = 0;
};
CHIMERA_COMPONENT(Source, "t_source", "A ramp.", rate = 1000.0);
