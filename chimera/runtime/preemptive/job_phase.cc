// SPDX-License-Identifier: Apache-2.0
// The moves of a job that end the program where the picture does not show them.
#include "chimera/runtime/preemptive/job_phase.h"

#include "chimera/base/assert.h"

namespace chimera {

void JobPhase::move(Value from, Value to) noexcept {
  CHIMERA_ASSERT(value() == from);
  value_.store(to, std::memory_order_release);
}

void JobPhase::begin_method() noexcept {
  CHIMERA_ASSERT(is_free());
  value_.store(kMethod, std::memory_order_release);
}

}  // namespace chimera
