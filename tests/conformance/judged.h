// SPDX-License-Identifier: Apache-2.0
// When a real-time test judges what it saw (docs/decisions/0004-judging-real-time.md).
#pragma once

#include <cstdio>
#include <optional>

#include "tests/conformance/witness.h"

namespace chimera::toy {

/// What `run` saw while even the witness was never later than `gap`; nothing when it was, in each of five tries.
template <class Run>
auto judged(Nanoseconds gap, Run run) -> std::optional<decltype(run())> {
  constexpr int kTries = 5;
  constexpr Nanoseconds kRest = milliseconds(500);  // real-time threads are throttled above 0.95 of a second
  Nanoseconds worst;
  for (int i = 0; i < kTries; ++i) {
    LinuxClock().wait_until(LinuxClock().now() + kRest);
    Witness witness;
    auto seen = run();
    worst = witness.worst();
    if (worst <= gap) return seen;
    std::printf("try %d: the witness was %lld us late\n", i + 1, static_cast<long long>(worst.count / 1000));
  }
  std::printf("not judged: host stalled %lld us\n", static_cast<long long>(worst.count / 1000));
  return std::nullopt;
}

}  // namespace chimera::toy
