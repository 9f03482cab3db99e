// SPDX-License-Identifier: Apache-2.0
// Aperiodic, so that sync is called as well.
#include "tests/components/ends.h"

struct EndsEvent : Ends {
  chimera::Outcome sync() { return act("sync"); }
};
CHIMERA_COMPONENT(EndsEvent, "t_ends_event", "Ends badly in one method, sync among them.", rate = 1000.0);
