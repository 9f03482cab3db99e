// SPDX-License-Identifier: Apache-2.0
// Decides what happens in a subsystem: a step function (event, time) -> actions without any call to the system, driven
// on Linux by chimera/manager and in virtual time by simulated processes. docs/formats/processes.md.
//
// What it knows of the processes it is told by events; what it must not forget it asks the driver to remember, and a
// new Subsystem given that memory goes on where the old one died. The driver carries out actions in order.
//
//                                       step(event, now)
//                                              |
//        RtpuUp TaskSeen --> ObservedState     |     PendingSignals <-- Reported, RtpuDown, 2 s without a report
//                                   |          |           |
//                 RtpuDown --> RestartPolicy   |           +--> one SignalResult for each, to the three that sent it
//                                   |          v
//          +--> Goals::advance          spawns what has goals, in the order of constants
//  until   |    CommandQueue::advance   judges, sends and answers `spawn off kill clear reinit` of clients
//  nothing |    OnTransaction::advance  sends the next tasks of an `on`, or rolls it back
//  changes +--- OnQueue::advance        begins the next transaction: goals first, then clients and tasks in turn
//                                              |
//                                              v
//                                       actions, in order
//
// Goals. A task has a goal while it is to be brought up: at the start, and again after its rtpu died. Goals are
// pursued in the order of constants (spawn) and then as one transaction in data-flow order (on).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/refusal.h"
#include "chimera/runtime/hosted/rtpu_block.h"
#include "chimera/subsystem/signal_refusal.h"

namespace chimera::subsystem {

/// Goal bits of a task (BlockView::goal).
inline constexpr std::uint32_t kGoalSpawn = 1, kGoalOn = 2;

/// Restart at most this often within this time, then give up until a person says `spawn` or `clear`.
inline constexpr int kRestartIntensity = 3;
inline constexpr Nanoseconds kRestartWindow = seconds(10);
/// A signal that is not reported on within this time fails.
inline constexpr Nanoseconds kAnswerLimit = seconds(2);
/// A `kill` that is under way, or that waits for an `init` under way, is waited for at most so long: by then the watch
/// over the methods of units has told which one it is.
inline constexpr Nanoseconds kKillLimit = milliseconds(2500);

// ---- events ----

/// The driver starts: what the previous manager remembered (all zero at the first start). Exactly once, first; then
/// RtpuUp/RtpuDown/TaskSeen for everything there is, then InventoryComplete.
struct Begun {
  std::vector<std::uint32_t> goals;     ///< by task
  std::vector<std::uint32_t> handled;   ///< by rtpu: incarnation whose death was dealt with
  std::vector<std::array<Nanoseconds, 4>> restarts;  ///< by rtpu: instants of its last restarts, 0: none
  bool started = false;                 ///< the start set was asked for by a previous manager
};
struct InventoryComplete {};
/// The rtpu serves: maps this manager's segment and takes posts from now on, none of an earlier manager. TaskSeen of
/// its tasks, read after it began to, have come before.
struct RtpuUp { RtpuId rtpu; std::uint32_t incarnation = 0; };
/// The process is dead (proof by pidfd). TaskSeen events with the last words of its segment have come before, also for
/// one that is found dead at the start. `cause` follows the name in a sentence: "ended by signal 11 (SIGSEGV) in
/// pid.cycle; core dumped". `is_end`: everything ends, and nobody starts it again. `is_orderly`: its tasks were turned
/// off and killed before.
struct RtpuDown { RtpuId rtpu; std::uint32_t incarnation = 0; std::string cause; bool is_end = false;
                  bool is_orderly = false; };
/// A status word as it is now.
struct TaskSeen { TaskId task; TaskStatus status; };
/// What became of a signal that was sent with a command number: one for each task of a Send. TaskSeen of the task, read
/// after the report was taken, has come before.
struct Reported { std::uint64_t command = 0; TaskId task; Signal signal = Signal::kOn; bool accepted = false;
                  Refusal why = Refusal::kNone; State before{}, after{}; std::string text; };
/// A task asked for `on` (only the manager may).
struct Requested { TaskId task; Signal signal = Signal::kOn; TaskId from; };
/// A face asked for it. `id` is the driver's, above 0, never twice.
struct Commanded { std::uint64_t id = 0; Signal signal = Signal::kOn; std::vector<TaskId> tasks; };
/// Nothing but time: due at next_due().
struct Tick {};

using Event = std::variant<Begun, InventoryComplete, RtpuUp, RtpuDown, TaskSeen, Reported, Requested, Commanded, Tick>;

// ---- actions ----

/// Post the signals to the rtpu as one transaction (`more` on all but the last). `command` is the Subsystem's own
/// number, to come back in Reported. `on` and `spawn` have been judged; the others go as they are.
struct Send { RtpuId rtpu; std::uint64_t command = 0; Signal signal = Signal::kOn; std::vector<TaskId> tasks; };
/// Does nothing when it lives.
struct StartRtpu { RtpuId rtpu; };
/// Must be remembered before any later action is carried out.
struct RememberGoal { TaskId task; std::uint32_t goal = 0; };
struct RememberHandled { RtpuId rtpu; std::uint32_t incarnation = 0; };
struct RememberRestart { RtpuId rtpu; std::array<Nanoseconds, 4> instants{}; };
struct RememberStarted {};
/// What a command did to one of its tasks.
struct TaskOutcome {
  TaskId task;
  State before{}, after{};
  bool is_already = false;  ///< there was nothing to do: `on` of a task that is ON, `off` of one that is OFF
};
/// A command is over.
struct CommandAnswer {
  std::uint64_t id = 0;
  SignalRefusal refusal;  ///< kNone: all of it was carried out
  TaskId at;              ///< the task that was refused
  std::vector<TaskOutcome> outcomes;

  bool is_accepted() const noexcept { return !refusal.is_refused(); }
};
/// For the event log: kind as in docs/formats/control.md.
struct LogEvent {
  std::string kind;
  TaskId task;
  RtpuId rtpu;
  std::string text;
};

using Action = std::variant<Send, StartRtpu, RememberGoal, RememberHandled, RememberRestart, RememberStarted,
                            CommandAnswer, LogEvent>;

/// One subsystem. Single-threaded; no clock of its own. Context: setup; may allocate.
class Subsystem {
 public:
  /// `spec` outlives it.
  explicit Subsystem(const ApplicationSpec& spec);
  ~Subsystem();

  /// Takes one event at `now` (never before the previous one) and appends what is to be done to `actions`.
  void step(const Event& event, Nanoseconds now, std::vector<Action>& actions);
  /// When a Tick is due; kNever: not before another event.
  Nanoseconds next_due() const noexcept;

  /// As people see it: a task of a dead rtpu that was created is ERROR.
  State state(TaskId task) const noexcept;
  /// Is every goal met or given up?
  bool is_settled() const noexcept;
  /// Is the rtpu dead, and nobody is to start it?
  bool is_given_up(RtpuId rtpu) const noexcept;
  /// What to type so that what it had comes back: "`chimera clear pi motor`, then `chimera on pi motor`";
  /// `chimera spawn` of its tasks where nothing is known to be lost.
  std::string way_back(RtpuId rtpu) const;
  /// Why the flag is up: "u (pi is OFF)"; "" when the tasks ON are a legal set.
  std::string missing() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace chimera::subsystem
