// SPDX-License-Identifier: Apache-2.0
// An rtpu from its start to its end: docs/formats/processes.md. It has three threads. The main thread (SCHED_OTHER)
// talks to the keeper and supervises; one thread cycles; one runs init and kill.
#pragma once

#include <cstdint>

#include "chimera/platform/process_state.h"

namespace chimera {

/// Exit code of an rtpu one of whose threads is gone.
inline constexpr int kThreadLost = 6;
/// Exit code of the rtpu of a board that is silent or was restarted: a successor waits for the board.
inline constexpr int kBoardLost = 7;

/// Arguments of the start of an rtpu, which takes ownership of the descriptors.
struct RtpuStart {
  std::uint32_t peer = 0;
  std::uint32_t incarnation = 1;
  pid_t parent = 0;  ///< process id of the keeper; 0: the keeper is in the same process
  int channel = -1, image = -1, decision_page = -1, keeper_page = -1, objects = -1;
  int guard = -1;    ///< the rtpu's end of its line to the guard; -1: there is none
};

/// Runs until the keeper says `finish`, SIGTERM comes, or the keeper is gone; then ends its tasks. Returns the exit
/// code: 0 ended in order; 1 could not start (`grant` of its block holds the reason). A method that exceeds its limit
/// or a lost thread ends the process at once, with 3 or kThreadLost. Context: setup; blocks.
int run_rtpu(const RtpuStart& start);

}  // namespace chimera
