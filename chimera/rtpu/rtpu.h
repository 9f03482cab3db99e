// SPDX-License-Identifier: Apache-2.0
// A real-time unit from its start to its end: docs/formats/processes.md. Three threads: this one (SCHED_OTHER) talks to
// the keeper and supervises, one cycles, one serves init and kill.
#pragma once

#include <cstdint>

#include "chimera/platform/process_state.h"

namespace chimera {

/// How a unit is started. The descriptors become its own.
struct RtpuStart {
  std::uint32_t peer = 0;
  std::uint32_t incarnation = 1;
  pid_t parent = 0;  ///< the keeper; 0: the same process, nobody to follow
  int channel = -1, image = -1, decision_page = -1, keeper_page = -1, objects = -1;
  int guard = -1;    ///< the unit's end of its line to the guard; -1: there is none
};

/// Runs until the keeper says `finish`, SIGTERM comes, or the keeper is gone; then ends its tasks. Answers the exit
/// code: 0 ended in order; 1 could not start (the reason stands in its block's `grant`); 3 a method took longer than
/// its limit at the end: the process must exit at once, a thread is still in it. Context: setup; blocks.
int run_rtpu(const RtpuStart& start);

}  // namespace chimera
