// SPDX-License-Identifier: Apache-2.0
// Advances virtual time.
#include "chimera/platform/virtual/virtual_clock.h"

#include "chimera/base/assert.h"

namespace chimera {

WaitEnd VirtualClock::wait_until(Nanoseconds instant) noexcept {
  if (instant <= now_) return WaitEnd::kReached;
  if (wake_ < instant) {
    if (wake_ > now_) now_ = wake_;  // a wake that came before the wait is taken at once
    wake_ = kNever;
    return WaitEnd::kWoken;
  }
  now_ = instant;
  return WaitEnd::kReached;
}

void VirtualClock::advance(Nanoseconds span) noexcept {
  CHIMERA_ASSERT(span.count >= 0);
  now_ += span;
}

}  // namespace chimera
