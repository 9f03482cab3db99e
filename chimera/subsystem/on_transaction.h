// SPDX-License-Identifier: Apache-2.0
// Turns tasks ON, all or none, one transaction at a time. This rule guarantees that a variable never has two producers.
//
// A transaction is judged against the tasks that are, or may be, ON. It is sent in data-flow order, neighbours of one
// rtpu together. After a failure the tasks that it turned ON are turned OFF in reverse order. Its tasks have the goal
// `on` until it is over, so that the next manager continues it.
//
//   stage of a member:  kOpen --`on` sent--> kSent --reported--> kOn   (it may be ON: rolled back after a failure)
//                           ^              |
//                           +--- not yet --+   asked again after a period; so are those behind it in its list
//                                                     roll-back: kOn --`off` sent--> kSent --reported--> kOver
#pragma once

#include <string>
#include <vector>

#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/subsystem_state.h"

namespace chimera::subsystem {

/// The tasks to turn ON, and the origin of the request.
struct OnRequest {
  std::uint64_t id = 0;  ///< command of a client; 0: none
  std::vector<TaskId> tasks;
  TaskId from;           ///< the task that asked
  bool is_goals = false; ///< the goals themselves
};

/// Context: setup.
class OnTransaction {
 public:
  OnTransaction(SubsystemState& state, Goals& goals) : state_(state), goals_(goals) {}

  bool is_under_way() const noexcept { return is_under_way_; }
  bool has(TaskId task) const noexcept;

  /// Judges the request, then begins or refuses it. Requires: no transaction is under way, no task of the request is
  /// busy.
  void begin(OnRequest request);
  void on_result(const SignalResult& result);
  /// A status word was read. The transaction fails if a member left ON by itself.
  void on_task_seen(TaskId task);
  /// Another command turns the task OFF or kills it: the transaction fails, and the goals of the other tasks stay.
  /// False if nothing changed.
  bool withdraw(TaskId task, Signal signal);
  void on_rtpu_down(RtpuId rtpu, const std::string& cause);

  /// Sends the next signals; ends the transaction when all reports are in. False if nothing changed.
  bool advance();
  /// Time of the next step if no report arrives; kNever: none.
  Nanoseconds next_due() const noexcept { return is_under_way_ ? again_at_ : kNever; }

  /// Answers a request that did not become a transaction, naming one of its tasks.
  void refuse(const OnRequest& request, TaskId task, const SignalRefusal& why);

 private:
  enum class Stage : std::uint8_t { kOpen, kSent, kOn, kOver };
  struct Member {
    TaskId task;
    State before = State::kOff;
    Stage stage = Stage::kOpen;
    bool is_withdrawn = false;  // another command turns it OFF
    bool is_half_on = false;    // its `on` answered not yet: `off` is owed
    std::uint64_t command = 0;
  };
  Member* find(TaskId task) noexcept;
  bool is_asked_again(const SignalResult& result);
  TaskId first_wrong(const OnRequest& request) const;
  void fail(TaskId task, SignalRefusal why, bool is_final);
  void send_next();
  void roll_back();
  bool is_waiting() const noexcept;
  void finish();
  void report_done(std::vector<TaskOutcome> outcomes) const;

  SubsystemState& state_;
  Goals& goals_;
  OnRequest request_;
  std::vector<Member> members_;
  std::vector<TaskId> already_;  // tasks that were ON at a person's request: neither sent nor rolled back
  bool is_under_way_ = false;
  bool is_final_ = false;  // the goals are given up with the transaction
  bool is_rolling_back_ = false;
  Nanoseconds until_;               // end of the time in which tasks that are not ready are asked again
  Nanoseconds again_at_ = kNever;   // next time to ask them
  std::uint64_t not_ready_ = 0;     // the last command with the answer "not ready"
  TaskId failed_at_;
  SignalRefusal refusal_;  // kNone: no refusal so far
};

}  // namespace chimera::subsystem
