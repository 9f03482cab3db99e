// SPDX-License-Identifier: Apache-2.0
// The demand of a task, and the order of jobs on a processor: the input of the analysis.
//
// Assumptions of every result:
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

/// A task, or the server of an aperiodic task: then `time` is its capacity and `deadline` its period.
struct Work {
  Nanoseconds period;    ///< above 0
  Nanoseconds deadline;  ///< relative, 0 < deadline <= period
  Nanoseconds offset;    ///< of the grid of releases; decides ties and data age only
  Nanoseconds time;      ///< longest execution time of a job, with transfers; 0: not stated
  std::uint32_t criticality = 0;
  std::uint32_t user_priority = 0;
  std::uint32_t rtpu = 0;  ///< index of its ProcessorUse
  std::uint32_t place = 0;  ///< TaskSpec::place
  std::optional<ServerKind> server;
};

/// kPreemptive: a more urgent job of the rtpu preempts a running job.
enum class Dispatch : std::uint8_t { kPreemptive, kExecutive };

/// An rtpu in the form of the analysis. Rtpus on one CPU have bands (schedule/bands.h): all tasks of a higher band run
/// before those of a lower one.
struct ProcessorUse {
  std::uint32_t cpu = 0;
  std::uint32_t criticality = 0;  ///< of its most critical task, ON or not: decides the band; ties by index
  Policy policy = Policy::kEdf;
  Dispatch dispatch = Dispatch::kPreemptive;
  Nanoseconds quantum = milliseconds(1);  ///< laxity policies: the running job is compared again at this interval
};

}  // namespace chimera
