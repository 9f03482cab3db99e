// SPDX-License-Identifier: Apache-2.0
// What a task asks of its processor, and how a processor orders what is asked: the input of the analysis.
//
// Assumptions of every figure made from it:
//   * a task releases jobs at least `period` apart, each of at most `time`; a set is judged for its worst case, all
//     released at one instant (offsets are ignored: they can only help);
//   * a job never waits for anything but the processor; the cost of switching and of transfers is part of `time`;
//   * the processor never idles while a job waits.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "chimera/base/time.h"
#include "chimera/schedule/policy.h"
#include "chimera/task/server_spec.h"

namespace chimera {

/// One task, or the server of an aperiodic one: then `time` is its capacity and `deadline` its period.
struct Work {
  Nanoseconds period;    ///< above 0
  Nanoseconds deadline;  ///< relative, 0 < deadline <= period
  Nanoseconds offset;    ///< of the grid of releases; decides ties and data age only
  Nanoseconds time;      ///< execution time of a job at most, transfers included; 0: not known
  std::uint32_t criticality = 0;
  std::uint32_t user_priority = 0;
  std::uint32_t rtpu = 0;  ///< index of its ProcessorUse
  std::optional<ServerKind> server;
};

/// Whether a job that runs can be taken off the processor by a more urgent one of its rtpu.
enum class Dispatch : std::uint8_t { kPreemptive, kExecutive };

/// An rtpu, as the analysis sees it. Those that share a CPU have bands (schedule/bands.h): a higher band goes before
/// everything of a lower one.
struct ProcessorUse {
  std::uint32_t cpu = 0;
  std::uint32_t criticality = 0;  ///< of its most critical task, ON or not: settles the band, ties by index
  Policy policy = Policy::kEdf;
  Dispatch dispatch = Dispatch::kPreemptive;
  Nanoseconds quantum = milliseconds(1);  ///< laxity policies: a running job is compared again this often
};

}  // namespace chimera
