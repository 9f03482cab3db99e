// SPDX-License-Identifier: Apache-2.0
// One instance of a component under the framework: the task of the papers. Plain data; the job step and the task set
// act on it (chimera/runtime). Members are grouped by their writers.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <type_traits>

#include "chimera/base/fixed.h"
#include "chimera/base/mechanisms.h"
#include "chimera/table/group.h"
#include "chimera/table/transfer.h"
#include "chimera/task/abi.h"
#include "chimera/task/declared_port.h"
#include "chimera/task/fault_record.h"
#include "chimera/task/profile.h"
#include "chimera/task/signal.h"
#include "chimera/task/state_machine.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// An in-var. The slot of its producer is latched before every method. It is used in place if the producer runs in this
/// context; otherwise the register copies it.
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

/// A signal that a method sent; it acts after the method.
struct SentSignal {
  Signal signal = Signal::kOff;
  TaskId target;
};

inline constexpr std::size_t kOutboxSize = mechanisms::kSignals ? 16 : 1;
using SentList = FixedVector<SentSignal, kOutboxSize>;
/// Signals that a method sent: a list for each task, or one for all where they are handed over before another method
/// runs. A switch keeps those of a task that it arms.
using TaskOutbox = std::conditional_t<mechanisms::kCopies || mechanisms::kSwitch, SentList, SentList&>;
inline constinit SentList sent_by_method{};

/// The target of a request: none, or lists of tasks that SentSignals keeps. Otherwise a configuration number.
inline constexpr std::uint16_t kNoRequest = UINT16_MAX, kListsRequested = UINT16_MAX - 1;

/// Takes the number of the running method if no process needs it. Never read: pairs with nothing.
inline std::atomic<std::uint32_t> running_untold{0};

/// The members that every job touches come first, on few cache lines: with a thousand tasks, cache misses dominate the
/// cost of a job.
struct alignas(kCacheLine) Task {
  // Constant after set-up, or after the construction of the component.
  chimera_method cycle = nullptr;  ///< the component's
  void* instance = nullptr;        ///< the component's state
  /// Receives the number of the running method, for the process that finds this one dead. Relaxed, pairs with nothing.
  std::atomic<std::uint32_t>* running = &running_untold;
  std::span<Output> outputs;
  std::uint64_t all_outputs = 0;  ///< the valid bits if every out-var has a value
  TaskId id;
  bool has_safety = false;  ///< at least one out-var is a safety port
  bool asks_sync = false;   ///< an aperiodic task: sync checks for an event before each cycle

  // Written by the job step, or at cycle boundaries. A flag stays beside `standing` if it can be true in several
  // standings: a warm task has jobs, news and rows for the tap, and a task in ERROR may be in service.
  bool is_tapped = false;  ///< set at cycle boundaries: each publication goes to the tap as a row
  bool is_busy = false;    ///< a job of the task is running; written by the executor
  bool has_news = false;   ///< a fault was recorded or a signal sent that is not handled yet
  bool by_events = false;  ///< without a server, a job for each event; written at cycle boundaries
  // Side by side from an even address: the compiler compares both with one load, which holds no byte that a job writes.
  alignas(2) State state = State::kNotCreated;
  Standing standing = Standing::kPlain;  ///< written at cycle boundaries only
  Method job_method = Method::kCycle;  ///< the present method of the job, such as sync or error; by atomic_ref
  std::span<Input> inputs;               ///< rebound at a cycle boundary when producers change
  std::span<LocalGroup* const> copies;   ///< of groups from other contexts, refreshed before the inputs are read
  GroupWriter group;
  std::uint64_t valid = 0;   ///< of the out-vars, as last published
  Nanoseconds last_release;  ///< of the last completed cycle; for dt
  const TaskSpec* spec = nullptr;
  chimera_background background = nullptr;  ///< set at cycle boundaries, from the end of init to kill; null: none
  chimera_call call{};
  TaskSaid said = said_by_method;  ///< the present method stores its fault here; faults keeps the last one
  Profile profile;

  // Rarely touched.
  TaskFaults faults;
  TaskOutbox outbox = sent_by_method;  ///< its end and the next four share a cache line, which jobs read
  /// The present job must give up, because it used up its budget. Relaxed, pairs with nothing: a job that sees it late
  /// gives up late.
  std::atomic<bool> give_up{false};
  std::uint16_t requested_set = kNoRequest;  ///< by the present method, in ApplicationSpec::sets; or a constant above
  std::uint32_t events = 0;  ///< events that no job has answered or is released for; by the executor
  int descriptor = -1;   ///< readable while there is an event, from the end of init to kill; below 0: none

  // Written by the executor and the task set at cycle boundaries.
  std::uint8_t requests_refused = 0;  ///< for configurations, since the start of the run; 255: or more
  bool is_error_told = false;  ///< its reaction on_fault has acted since it went to ERROR
  SignalList<kOutboxSize> pending;  ///< signals that wait for the present method to end
  const chimera_component* component = nullptr;  ///< from the construction of the component on
  DeclaredPorts ports;  ///< of the component, from its construction on
  chimera_inherited* inherited = nullptr;  ///< by output: the inherited value of its port at the last on

  /// The state that other tasks and users see.
  State shown_state() const noexcept { return is_warm() ? State::kOff : state; }
  /// False also after a fault of a hot standby, although it keeps its standing until the next cycle boundary.
  bool is_warm() const noexcept { return standing == Standing::kWarm && state == State::kOn; }
  bool in_service() const noexcept { return standing == Standing::kInService; }
  /// True if `off` must run before `signal` has its effect. Then `off` is legal, although other tasks see OFF.
  bool owes_off_before(Signal signal) const noexcept {
    return standing == Standing::kOwesOff || (signal != Signal::kOn && (standing == Standing::kHalfOn || is_warm()));
  }
  /// True if the last method sent signals or requested a configuration, and neither is handled yet.
  bool has_sent() const noexcept { return !outbox.empty() || requested_set != kNoRequest; }
  void forget_sent() noexcept {
    outbox.clear();
    requested_set = kNoRequest;
  }
};

}  // namespace chimera
