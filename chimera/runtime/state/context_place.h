// SPDX-License-Identifier: Apache-2.0
// Place of one context in the application: its tasks, its memory, and the other contexts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/runtime/safe_frame.h"
#include "chimera/runtime/service.h"
#include "chimera/runtime/state/peer_view.h"
#include "chimera/task/task.h"

namespace chimera {

/// By default a context is alone: all tasks and operator variables are its own. What it points at outlives the context.
struct ContextPlace {
  RtpuId rtpu;                     ///< whose tasks are its own; invalid: all
  std::span<std::byte> table;      ///< zeroed bytes for PeerLayout::of(spec, rtpu); empty: memory of its own
  PeerView* others = nullptr;
  SafeFrames* safe_frames = nullptr;  ///< null: no process writes them
  Service* service = nullptr;  ///< null: init and kill run where the signal is taken
  // Words for the process that finds this one dead or hanging (TaskWord): written relaxed, pair with nothing.
  /// Shows which task and method runs, as BlockHead::running: written by the context, and by the service thread.
  std::atomic<std::uint32_t>* running = &running_untold;
  std::atomic<std::uint32_t>* serving = &running_untold;
  bool preemptive = false;  ///< tasks preempt each other: each reads through copies of its own
  /// Shows which method is called at a cycle boundary. `running` shows only jobs.
  std::atomic<std::uint32_t>* at_edge = &running_untold;
  /// Shows for which task a state is constructed, by show_making().
  std::atomic<std::uint32_t>* making = &running_untold;
  std::uint32_t incarnation = 1;  ///< of its process: one more after each of its deaths
};

}  // namespace chimera
