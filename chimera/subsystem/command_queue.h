// SPDX-License-Identifier: Apache-2.0
// Commands of clients other than `on`. Each is judged as one step, sent, and answered when all reports are in.
//
//   stage of a task of a command:
//     kOpen --judged, signal sent-----------------> kSent --reported--> kOver
//     kOpen --`spawn`, or `clear` of a dead one---> kGoal --reached or given up--> kOver
//     kOpen --nothing to do: OFF already, or its goal or transaction was taken back--> kOver
//
// A command begins when every task of it may go (Verdict::kGo); it is refused as a whole when one of them is wrong.
// `off` and `kill` take goals and transactions back while they wait.
#pragma once

#include <list>
#include <string>
#include <vector>

#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/on_transaction.h"
#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {

/// Context: setup.
class CommandQueue {
 public:
  CommandQueue(SubsystemState& state, Goals& goals, OnTransaction& transaction)
      : state_(state), goals_(goals), transaction_(transaction) {}

  void add(const Commanded& command);
  /// Judges the waiting commands, sends the signals that may go, answers finished commands. False if nothing changed.
  bool advance();
  void on_result(const SignalResult& result);
  /// The rtpu died. Call this before RestartPolicy sets the goals of its tasks again.
  void on_rtpu_down(RtpuId rtpu, const std::string& cause);
  Nanoseconds next_due() const noexcept;

 private:
  enum class Stage : std::uint8_t { kOpen, kSent, kGoal, kOver };
  struct Part {
    TaskId task;
    State before = State::kNotCreated;
    State after = State::kNotCreated;
    Stage stage = Stage::kOpen;
    bool is_taken_back = false;      // this command took back a goal or a transaction of the task
    bool is_already = false;         // the task was in the wanted state before
    bool has_seen_spawning = false;  // another command or goal spawned the task while this command waited
    std::uint64_t command = 0;
  };
  struct Command {
    std::uint64_t id = 0;
    Signal signal = Signal::kOff;
    std::vector<Part> parts;
    Nanoseconds arrived;
    bool is_begun = false;
    TaskId failed_at;
    SignalRefusal refusal;  // kNone: no refusal so far
  };
  enum class Verdict : std::uint8_t { kGo, kWait, kIllegal, kRival, kNoAnswer };

  static bool takes_down(Signal signal) noexcept { return signal == Signal::kOff || signal == Signal::kKill; }
  static std::vector<TaskId> tasks_of(const Command& command);
  bool is_revival(const Command& command, TaskId task) const noexcept;
  bool is_spawned_meanwhile(const Command& command, const Part& part) const noexcept;
  bool can_be_taken_back(Signal signal, TaskId task) const;
  State state_for(Signal signal, TaskId task) const noexcept;
  Verdict judge(const Command& command, const Part& part) const;
  Verdict judge_taking_down(const Command& command, const Part& part, bool waits_for_rtpu) const;
  Nanoseconds due_for_rtpu(const Command& command, const Part& part) const noexcept;
  Nanoseconds due_for_spawn(const Command& command, const Part& part) const noexcept;
  bool try_begin(Command& command, bool& changed);
  bool refuse_or_wait(Command& command);
  bool take_back(Command& command);
  void begin(Command& command);
  void begin(const Command& command, Part& part);
  void revive(const Command& command, Part& part);
  void send(Command& command);
  void look_at_goals(Command& command);
  void fail(Command& command, TaskId task, SignalRefusal why);
  bool try_finish(Command& command);

  SubsystemState& state_;
  Goals& goals_;
  OnTransaction& transaction_;
  std::list<Command> commands_;
};

}  // namespace chimera::subsystem
