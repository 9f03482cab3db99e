// SPDX-License-Identifier: Apache-2.0
// The state from which the manager makes all its answers.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chimera/manager/state/bundle.h"
#include "chimera/manager/state/event_log.h"
#include "chimera/manager/state/own_segment.h"
#include "chimera/manager/state/peers.h"
#include "chimera/manager/state/readings.h"
#include "chimera/platform/clock.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/pages.h"
#include "chimera/runtime/plan/rivals.h"
#include "chimera/subsystem/subsystem.h"

namespace chimera::manager {

/// Facts about an rtpu from the keeper and from this manager's checks.
struct RtpuRecord {
  std::int32_t pid = 0;
  std::uint32_t incarnation = 0;  ///< the last one that was started
  bool is_alive = false;
  bool is_up = false;          ///< serves this manager
  std::uint32_t restarts = 0;  ///< starts beyond the first
  std::string last_end;        ///< "ended by signal 9 (SIGKILL)"; "" if it never ended
  bool is_away = false;        ///< alive, but does not run: its data is out of date
  bool is_overwritten = false; ///< its memory was overwritten: nothing in it is believed, and it is killed
  std::string hang;            ///< object or method that does not run or end: "log.init for 2.0 s"; "": none
  std::string ended_for;       ///< reason why this manager had it killed; "": it did not
  std::uint64_t resident_bytes = 0, first_resident_bytes = 0;  ///< now, and when it was ON; 0: unknown
  std::string lost_rights;  ///< the part of its real-time rights that is not as granted any more
};

/// ManagerLoop owns it. The other classes read it, and act through publish_operator(), raise_flag() and tap().
struct ManagerState {
  ManagerState(Bundle given, Peers mapped, OwnSegment segment, DecisionPage& shared, const KeeperPage& keepers);
  ManagerState(const ManagerState&) = delete;
  ManagerState& operator=(const ManagerState&) = delete;

  Bundle bundle;
  std::optional<Configuration> configuration;  ///< none: idle
  Peers peers;
  OwnSegment own;
  DecisionPage& page;
  const KeeperPage& keeper;
  subsystem::Subsystem logic;
  HeapMemory memory;  ///< memory of `rivals`
  Rivals rivals;
  EventLog log;
  std::optional<Readings> readings;  ///< none: idle
  std::vector<RtpuRecord> rtpus;
  std::vector<std::uint32_t> tap_users;  ///< by task: subscriptions that want its publications
  std::int32_t keeper_pid = 0;
  std::string keeper_hang, guard_hang;  ///< "" while it runs
  std::function<void(const LoggedEvent&)> keep;  ///< called with each event before a client can see it; may be null
  std::string acting;                   ///< Asker::text() of the request that is being carried out; "": none is

  const ApplicationSpec& spec() const noexcept { return peers.spec(); }
  /// State as users see it: a task of an rtpu that does not run counts as ERROR, like a task of a dead rtpu.
  State state(TaskId task) const noexcept {
    const State state = logic.state(task);
    const RtpuRecord& rtpu = rtpus[spec().tasks[task.index].rtpu.index];
    return rtpu.is_away && (rtpu.is_overwritten || state != State::kNotCreated) ? State::kError : state;
  }
  /// Counts of the task in its rtpu; empty if there is no rtpu or the counts are not credible.
  Profile profile(TaskId task) const noexcept;
  /// The last fault of the task; none if it is not credible.
  FaultRecord fault(TaskId task) const noexcept;
  /// The tasks that are ON, as users see them.
  TaskBits tasks_on() const noexcept {
    TaskBits on;
    for (std::size_t t = 0; t < spec().tasks.size(); ++t)
      if (state(TaskId(t)) == State::kOn) on.add(TaskId(t));
    return on;
  }
  /// True if the keeper has begun to end the run. Acquire: pairs with the keeper's store of KeeperPage::ending.
  bool is_ending() const noexcept { return keeper.ending.load(std::memory_order_acquire) != 0; }
  /// From where the seconds of texts count, as in `run`: the start, when all tasks were ON; before it, the origin.
  Nanoseconds zero() const noexcept {
    const std::int64_t started = own.block().memory().started_at;
    return started != 0 ? Nanoseconds{started} : keeper.origin;
  }
  std::string name(TaskId task) const { return std::string(spec().tasks[task.index].name); }
  std::string name(RtpuId rtpu) const { return std::string(spec().rtpus[rtpu.index].name); }

  /// Numbers and keeps an event. A successor has event and number before any client can see the event.
  void tell(std::string kind, TaskId task, RtpuId rtpu, std::string text, Nanoseconds at);
  /// Wakes all peers to read this manager's block, because it has changed.
  void announce() noexcept;
};

/// While this lives, each event names `by`, an Asker::text(), as the author of its request. Context: setup.
class Acting {
 public:
  Acting(ManagerState& state, std::string by) : state_(state), before_(std::exchange(state.acting, std::move(by))) {}
  Acting(const Acting&) = delete;
  Acting& operator=(const Acting&) = delete;
  ~Acting() { state_.acting = std::move(before_); }

 private:
  ManagerState& state_;
  std::string before_;
};

/// The time of the manager: CLOCK_MONOTONIC, or the clock of use_clock(). Context: any; wait-free.
Nanoseconds now() noexcept;
/// For tests: now() reads `clock` from here on; nullptr: CLOCK_MONOTONIC again. Context: setup.
void use_clock(Clock* clock) noexcept;
/// Nanoseconds since 1970 at the monotonic instant `at`.
std::int64_t wall_ns(Nanoseconds at) noexcept;

}  // namespace chimera::manager
