// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "chimera/platform/clock.h"

namespace chimera {

/// CLOCK_MONOTONIC. A wait ends early when a signal handler ran in the waiting thread. A signal handled just
/// before the wait began does not end it: whoever sets a flag in a handler sees it at most one wait later.
class LinuxClock final : public Clock {
 public:
  Nanoseconds now() noexcept override;
  WaitEnd wait_until(Nanoseconds instant) noexcept override;
};

}  // namespace chimera
