// SPDX-License-Identifier: Apache-2.0
// Time as a running method sees it: the executor's clock, and the way to use time there.
#pragma once

#include "chimera/base/time.h"

namespace chimera {

/// One per context, by its executor. Context: cycle; wait-free, except that spend() computes in real time.
class JobClock {
 public:
  virtual Nanoseconds now() noexcept = 0;
  /// Uses `time` of execution time: computes in real time, adds modelled time in virtual time.
  virtual void spend(Nanoseconds time) noexcept = 0;

 protected:
  ~JobClock() = default;
};

}  // namespace chimera
