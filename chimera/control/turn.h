// SPDX-License-Identifier: Apache-2.0
// The time that one turn of work for many connections may take before other work comes first again.
#pragma once

#include "chimera/control/limits.h"
#include "chimera/platform/clock.h"

namespace chimera::control {

/// Begins when it is made. Reads the clock itself: work takes the time it takes, in a test with stepped time as well.
/// Context: setup.
class Turn {
 public:
  Turn() noexcept : ends_(LinuxClock().now() + kTurn) {}
  bool is_over() const noexcept { return LinuxClock().now() >= ends_; }

 private:
  Nanoseconds ends_;
};

}  // namespace chimera::control
