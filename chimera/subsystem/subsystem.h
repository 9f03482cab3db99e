// SPDX-License-Identifier: Apache-2.0
// Decides for a subsystem: a step function (event, time) -> actions without any system call. chimera/manager calls it;
// tests/stepped runs both on a stepped clock. docs/formats/processes.md.
//
// Events report the state of the processes. ManagerLoop carries out the actions in order and stores the contents of all
// Remember... actions. A new Subsystem that gets them continues the work of its predecessor.
//
//                                       step(event, now)
//                                              |
//        RtpuUp TaskSeen --> ObservedState     |     PendingSignals <-- Reported, RtpuDown, 2 s without a report
//                                   |          |           |
//                 RtpuDown --> RestartPolicy   |           +--> one SignalResult for each, to the three that sent it
//                                   |          v
//          +--> Goals::advance          spawns tasks that have goals, in the order of constants
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
/// Goal bit: a person turned the task OFF. It stays OFF until a person says otherwise: a task's `on` is refused.
inline constexpr std::uint32_t kGoalOff = 8;

/// An rtpu is restarted at most this often within this time, then given up until a person sends `spawn` or `clear`.
inline constexpr int kRestartIntensity = 3;
inline constexpr Nanoseconds kRestartWindow = seconds(10);
/// A signal without a report within this time fails.
inline constexpr Nanoseconds kAnswerLimit = seconds(2);
/// Longest wait for a `kill` under way, or for an `init` before it. Within this time the watch over hanging methods
/// names the method.
inline constexpr Nanoseconds kKillLimit = milliseconds(2500);

// ---- events ----

/// ManagerLoop starts, with the memory of the previous manager (all zero at the first start). Sent once, before all
/// other events. RtpuUp, RtpuDown and TaskSeen for every process and task follow, then InventoryComplete.
struct Begun {
  std::vector<std::uint32_t> goals;     ///< by task
  std::vector<std::uint32_t> handled;   ///< by rtpu: incarnation whose death was handled
  std::vector<std::array<Nanoseconds, 4>> restarts;  ///< by rtpu: instants of its last restarts, 0: none
  bool started = false;                 ///< a previous manager requested the start set
};
struct InventoryComplete {};
/// The rtpu serves: it maps this manager's segment and accepts its posts, none of an earlier manager. TaskSeen of its
/// tasks, read after that instant, came before.
struct RtpuUp { RtpuId rtpu; std::uint32_t incarnation = 0; };
/// The process is dead (proof by pidfd). TaskSeen events with the last status words of its segment came before, also
/// for an rtpu that is found dead at the start. `cause` follows the name in a sentence: "ended by signal 11 (SIGSEGV)
/// in pid.cycle; core dumped". `is_end`: the whole run ends, and the rtpu is not restarted. `is_orderly`: its tasks
/// were turned off and killed before.
struct RtpuDown { RtpuId rtpu; std::uint32_t incarnation = 0; std::string cause; bool is_end = false;
                  bool is_orderly = false; };
/// The present status word of a task.
struct TaskSeen { TaskId task; TaskStatus status; };
/// The report on a signal that was sent with a command number: one for each task of a Send. TaskSeen of the task, read
/// after the report arrived, came before.
struct Reported { std::uint64_t command = 0; TaskId task; Signal signal = Signal::kOn; bool accepted = false;
                  Refusal why = Refusal::kNone; State before{}, after{}; std::string text; };
/// A task asked for `on` (only the manager may).
struct Requested { TaskId task; Signal signal = Signal::kOn; TaskId from; };
/// A client requested a signal. ManagerLoop chooses `id`: above 0, never used twice.
struct Commanded { std::uint64_t id = 0; Signal signal = Signal::kOn; std::vector<TaskId> tasks; };
/// A person switches to the tasks `on`, and names the tasks `off`, which stay OFF.
struct PersonSwitches { TaskBits on, off; };
/// Only time passed: due at next_due().
struct Tick {};

using Event = std::variant<Begun, InventoryComplete, RtpuUp, RtpuDown, TaskSeen, Reported, Requested, Commanded,
                           PersonSwitches, Tick>;

// ---- actions ----

/// Post the signals to the rtpu as one transaction (`more` on all but the last). `command` is the Subsystem's own
/// number; Reported returns it. `on` and `spawn` have been judged before; the rtpu judges the others.
struct Send { RtpuId rtpu; std::uint64_t command = 0; Signal signal = Signal::kOn; std::vector<TaskId> tasks; };
/// Start the rtpu; no effect if it lives.
struct StartRtpu { RtpuId rtpu; };
/// Remember the goal before any later action is carried out.
struct RememberGoal { TaskId task; std::uint32_t goal = 0; };
struct RememberHandled { RtpuId rtpu; std::uint32_t incarnation = 0; };
struct RememberRestart { RtpuId rtpu; std::array<Nanoseconds, 4> instants{}; };
struct RememberStarted {};
/// Effect of a command on one of its tasks.
struct TaskOutcome {
  TaskId task;
  State before{}, after{};
  bool is_already = false;  ///< no change was needed: `on` of a task that is ON, `off` of one that is OFF
};
/// A command is over.
struct CommandAnswer {
  std::uint64_t id = 0;
  SignalRefusal refusal;  ///< kNone: the whole command was carried out
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

  /// Handles one event at `now` (never before the previous one) and appends the actions that follow to `actions`.
  void step(const Event& event, Nanoseconds now, std::vector<Action>& actions);
  /// Time at which a Tick is due; kNever: only another event continues.
  Nanoseconds next_due() const noexcept;

  /// State as users see it: a created task of a dead rtpu is in ERROR.
  State state(TaskId task) const noexcept;
  /// True if a person turned the task OFF, and no person has turned it ON since.
  bool is_kept_off(TaskId task) const noexcept;
  /// True if every goal is met or given up.
  bool is_settled() const noexcept;
  /// True if the rtpu is dead and will not be restarted.
  bool is_given_up(RtpuId rtpu) const noexcept;
  /// Commands that bring the lost tasks of the rtpu back: "`chimera clear pi motor`, then `chimera on pi motor`";
  /// `chimera spawn` of its tasks if none is known to be lost.
  std::string way_back(RtpuId rtpu) const;
  /// Reason why the flag is up: "u (pi is OFF)"; "" if the tasks that are ON are a legal set.
  std::string missing() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace chimera::subsystem
