// SPDX-License-Identifier: Apache-2.0
// How an executor runs the tasks of a context, and why a run ended.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/runtime/background_threads.h"
#include "chimera/runtime/cycle/script.h"
#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/life/boundary_listener.h"
#include "chimera/runtime/life/event_inputs.h"
#include "chimera/runtime/plan/switch_receipt.h"
#include "chimera/runtime/plan/switch_request.h"
#include "chimera/runtime/record/digest.h"
#include "chimera/runtime/record/tap_ring.h"
#include "chimera/runtime/switch/switch_peers.h"
#include "chimera/schedule/policy.h"

namespace chimera {

/// All pointers of it outlive the executor. Context: setup.
struct RunOptions {
  Policy policy = Policy::kEdf;
  Script script;
  Tap* tap = nullptr;                        ///< null: nothing is recorded
  Digest* digest = nullptr;                  ///< null: none
  std::uint8_t rtpu = 0;                     ///< for the records
  BoundaryListener* guest = nullptr;         ///< null: cycle boundaries have no listener
  EventInputs* events = nullptr;              ///< events of tasks beside rings; null: none. Not with `preemptive`
  Nanoseconds tick = milliseconds(1);        ///< between two looks at `events`, counted from the origin; > 0
  const std::atomic<bool>* stop = nullptr;   ///< checked before every job; may be set by a signal handler
  ReceiptReader* receipts = nullptr;         ///< takes them instead of Releases::receipts(); null: they are kept
  SwitchPeers* switch_peers = nullptr;       ///< null: switches are asked for by the script, or there are none
  /// Target sets of lists of tasks. Null: with `switch_peers` others know them, otherwise no task may ask for lists.
  AskedTasks* asked = nullptr;
  JobThreads* threads = nullptr;             ///< null: jobs run in the thread of the cycle boundaries
  BackgroundThreads* writer = nullptr;        ///< runs the background of components; MethodRunner::writer
  bool preemptive = false;                   ///< jobs preempt each other, and may go on below all others
};

/// Why a run ended.
enum class RunEnd : std::uint8_t {
  kTime,         ///< the stated time is over
  kStopped,      ///< RunOptions::stop was set
  kNothingLeft,  ///< no task is ON and no act or signal can change that
  kTaskStopped,  ///< the reaction `stop` of a task
};

}  // namespace chimera
