// SPDX-License-Identifier: Apache-2.0
// Trace of the runtime: fixed-size records in a bounded ring.
// Traces, timelines, logs and the scope read these and nothing else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"

namespace chimera {

enum class TapKind : std::uint8_t {
  kRelease,  ///< a job became ready; a = cycle number, b = ns to its deadline, 0: none
  kRun,      ///< a task held the processor from `at` for `b` ns; a = method
  kPreempt,  ///< a more urgent job took the processor
  kMiss,     ///< a cycle ended after its deadline; b = lateness in ns
  kDrop,     ///< a = releases dropped
  kSignal,   ///< a = signal, b = 1 accepted, 0 refused
  kFault,    ///< a = method
  kState,    ///< a = new state
  kFlag,     ///< a = 1 raised, 0 lowered
  kGroup,    ///< a row begins: publication of `task` at `at`; a = words that follow, b = sequence of the publication
  kValue,    ///< a word of the row; a = its place from 0, b = 8 bytes of the payload as they lie in memory
  kOverrun,  ///< a job was seen to have used more than its budget, mostly while it ran; b = ns used
  kHang,     ///< a job does not end by itself; b = ns used
};
/// Their words in traces and in the control protocol. Rows have a format of their own there.
inline constexpr std::array kTapKinds = {"release", "run",   "preempt", "miss",  "drop",    "signal", "fault",
                                         "state",   "flag",  "group",   "value", "overrun", "hang"};
static_assert(kTapKinds.size() == static_cast<std::size_t>(TapKind::kHang) + 1);

/// 32 bytes, none of them padding. Context: cycle; wait-free.
struct TapRecord {
  Nanoseconds at;
  std::int64_t b = 0;
  std::uint32_t a = 0;
  TaskId task;
  TapKind kind = TapKind::kRelease;
  std::uint8_t rtpu = 0;
  std::uint16_t reserved = 0;
  std::uint32_t row = 0;  ///< kGroup, kValue: number of the row among those of its task in this ring, from 0
};
static_assert(sizeof(TapRecord) == 32);

}  // namespace chimera
