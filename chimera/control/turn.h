// SPDX-License-Identifier: Apache-2.0
// The time that one turn of work for many connections may take before other work comes first again.
#pragma once

#include <ctime>

#include "chimera/control/limits.h"

namespace chimera::control {

/// Begins when it is made. Reads the clock itself: work takes the time it takes, in a test with stepped time as well.
/// Context: setup.
class Turn {
 public:
  Turn() noexcept : ends_(clock() + kTurn) {}
  bool is_over() const noexcept { return clock() >= ends_; }

 private:
  static Nanoseconds clock() noexcept {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return {t.tv_sec * 1'000'000'000 + t.tv_nsec};
  }

  Nanoseconds ends_;
};

}  // namespace chimera::control
