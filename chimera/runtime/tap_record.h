// SPDX-License-Identifier: Apache-2.0
// What the runtime tells about itself while it runs: fixed-size records in a bounded ring (design section 6).
// Traces, timelines, logs and the scope read these and nothing else.
#pragma once

#include <cstdint>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"

namespace chimera {

enum class TapKind : std::uint8_t {
  kRelease,  ///< a job became ready; a = cycle number
  kRun,      ///< a task held the processor from `at` for `b` ns; a = method
  kPreempt,  ///< a more urgent job took the processor
  kMiss,     ///< a cycle ended after its deadline; b = lateness in ns
  kDrop,     ///< a = releases dropped
  kSignal,   ///< a = signal, b = 1 accepted, 0 refused
  kFault,    ///< a = method
  kState,    ///< a = new state
  kFlag,     ///< a = 1 raised, 0 lowered
};

/// 32 bytes. Context: cycle; wait-free.
struct TapRecord {
  Nanoseconds at;
  std::int64_t b = 0;
  std::uint32_t a = 0;
  TaskId task;
  TapKind kind = TapKind::kRelease;
  std::uint8_t rtpu = 0;
  std::uint8_t reserved[6] = {};
};
static_assert(sizeof(TapRecord) == 32);

}  // namespace chimera
