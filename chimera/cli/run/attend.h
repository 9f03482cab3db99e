// SPDX-License-Identifier: Apache-2.0
// The run client of one `chimera run` in real time: watches, acts at stated times, judges, prints. It is a process of
// its own that talks the control protocol and nothing else, so a run goes on without it.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "chimera/cli/print/outlet.h"
#include "chimera/cli/print/run_log.h"
#include "chimera/cli/run/run.h"
#include "chimera/runtime/hosted/face_page.h"

namespace chimera::cli {

struct AttendRequest {
  std::string socket;          ///< path of the subsystem's
  RunRequest run;              ///< of these: duration, every, watch, at, expect, json
  std::vector<Bound> bounds;  ///< of run.expect
  int keeper = 0;              ///< process that ends the tasks when it gets SIGUSR1; 0: none
  FacePage* page = nullptr;    ///< progress of earlier run clients; null: there was none, and none will follow
  RunLog* log = nullptr;       ///< gets each event; may be null
  Outlet* outlet = nullptr;    ///< of `out`: asked for losses, which SIGUSR2 reports to the keeper; may be null
};

/// Waits for the start, attends until the end of the duration or request_stop(), reports; answers the exit code of the
/// run. What it prints may be lost: the run goes on, and the code is 1 at its end. `sink` may be null. Context: setup;
/// blocks.
int attend(const AttendRequest& request, RecordSink* sink, std::FILE* out, std::FILE* err);

}  // namespace chimera::cli
