// SPDX-License-Identifier: Apache-2.0
// One instance of a component under the framework: the papers' task. Plain data; the job step and the task
// set act on it (chimera/runtime). Members are grouped by who may write them.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "chimera/base/fixed.h"
#include "chimera/table/group.h"
#include "chimera/table/transfer.h"
#include "chimera/task/abi.h"
#include "chimera/task/fault_record.h"
#include "chimera/task/profile.h"
#include "chimera/task/state_machine.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// An in-var. Its producer's slot is latched before every method: in place when it runs in the same context, else
/// copied through the register.
struct Input {
  chimera_port* port = nullptr;
  GroupInput group;
  std::uint32_t offset = 0;    ///< of the value in the producer's payload
  std::uint32_t bit = 0;       ///< of the value in the producer's valid bits
  std::uint64_t sequence = 0;  ///< of the publication that the last cycle read
};

/// An out-var of this task.
struct Output {
  chimera_port* port = nullptr;
  const PortSpec* spec = nullptr;
  std::uint32_t offset = 0;  ///< of the value in this task's payload
  std::uint32_t bytes = 0;   ///< reserved (extents at their maxima)
};

/// A signal sent by a method, acted upon after it.
struct SentSignal {
  Signal signal = Signal::kOff;
  TaskId target;
};

inline constexpr std::size_t kOutboxSize = 16;

/// Where a method asks for a configuration: for none, or for lists of tasks, which SentSignals keeps.
inline constexpr std::uint16_t kNoRequest = UINT16_MAX, kListsRequested = UINT16_MAX - 1;

/// Where a task tells which method runs while nobody wants to know. Never read: pairs with nothing.
inline std::atomic<std::uint32_t> running_untold{0};

/// What every job touches comes first, on as few cache lines as it takes: with a thousand tasks a job costs what it
/// brings into the cache.
struct alignas(64) Task {
  // Fixed at set-up, or from the construction of the component on.
  chimera_method cycle = nullptr;  ///< the component's
  void* instance = nullptr;        ///< the component's state
  /// Told which method runs, for who finds the process dead: relaxed, pairs with nothing.
  std::atomic<std::uint32_t>* running = &running_untold;
  std::span<Output> outputs;
  std::uint64_t all_outputs = 0;  ///< the valid bits when every out-var has a value
  TaskId id;
  bool has_safety = false;  ///< some out-var is a safety port
  bool asks_sync = false;   ///< an aperiodic task: before each cycle sync says whether there is an event

  // Written by the job step, or at edges.
  bool is_tapped = false;  ///< set at edges: every publication goes to the tap as a row
  bool is_busy = false;    ///< a job of it is under way; by the executor
  Method job_method = Method::kCycle;  ///< which its job is in, sync or error for a time; by atomic_ref, to be told
  bool has_news = false;   ///< a fault was recorded or a signal sent that nobody has looked at
  State state = State::kNotCreated;
  bool is_unread = false;  ///< a hot standby: it cycles as a task does that is ON, and counts as OFF for all others
  std::span<Input> inputs;               ///< rebound at an edge when producers change
  std::span<LocalGroup* const> copies;   ///< of groups produced elsewhere, refreshed before the inputs are read
  GroupWriter group;
  std::uint64_t valid = 0;   ///< of the out-vars, as last published
  Nanoseconds last_release;  ///< of the last completed cycle; for dt
  const TaskSpec* spec = nullptr;
  chimera_background background = nullptr;  ///< set at edges, from the end of init to kill; null: it has none
  chimera_call call{};
  chimera_fault said{};  ///< where the present method leaves its fault; faults keeps the last one
  Profile profile;

  // Touched now and then.
  FaultRecord faults;
  FixedVector<SentSignal, kOutboxSize> outbox;  ///< its end and the next four share a cache line: jobs look there
  /// The present job was told to: it used up its budget. Relaxed, pairs with nothing: a job that sees it late gives up
  /// late.
  std::atomic<bool> give_up{false};
  std::uint16_t requested_set = kNoRequest;  ///< by the present method, in ApplicationSpec::sets; or above
  std::uint32_t events = 0;  ///< behind a server: rings of its doorbell that no job has answered; by the executor
  int descriptor = -1;   ///< readable while there is an event, from the end of init to kill; below 0: none

  // Written by the executor and the task set at edges.
  bool in_service = false;  ///< init or kill is run by the service thread: nobody else touches the task
  std::uint8_t requests_refused = 0;  ///< for configurations, since the start of the run; 255: or more
  bool is_error_told = false;  ///< its reaction on_fault has acted since it went to ERROR
  bool owes_off = false;    ///< OFF, with `on` behind it and `off` before it: armed for a switch, or left by one
  bool is_half_on = false;  ///< OFF, `on` answered not yet: `off` is owed unless `on` goes on
  FixedVector<Signal, kOutboxSize> pending;  ///< signals that wait for the present method to end
  const chimera_component* component = nullptr;  ///< from the construction of the component on
  chimera_inherited* inherited = nullptr;  ///< by output: what its port was told at the last on

  /// As others see it.
  State shown_state() const noexcept { return is_unread && state == State::kOn ? State::kOff : state; }
  /// The last method sent signals, or asked for a configuration, and nobody has looked at that.
  bool has_sent() const noexcept { return !outbox.empty() || requested_set != kNoRequest; }
  void forget_sent() noexcept {
    outbox.clear();
    requested_set = kNoRequest;
  }
};

}  // namespace chimera
