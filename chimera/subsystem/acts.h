// SPDX-License-Identifier: Apache-2.0
// What faces asked for other than `on`: judged as one step, sent at once, answered when all reports are in.
//
// `off` and `kill` also take goals back. `spawn`, and `clear` of a task whose process is dead, become goals.
#pragma once

#include <list>
#include <string>
#include <vector>

#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/situation.h"
#include "chimera/subsystem/transaction.h"

namespace chimera::subsystem {

/// Context: setup.
class Acts {
 public:
  Acts(Situation& situation, Goals& goals, Transaction& transaction)
      : at_(situation), goals_(goals), transaction_(transaction) {}

  void add(const Commanded& command);
  /// Judges what waits, sends what may be sent, answers what is over.
  void advance();
  void take(const Reply& reply);
  /// An rtpu died; before its goals are found anew.
  void lose(RtpuId rtpu, const std::string& cause);
  Nanoseconds next_due() const noexcept;

 private:
  enum class Stage : std::uint8_t { kOpen, kSent, kGoal, kOver };
  struct Part {
    TaskId task;
    State before = State::kNotCreated;
    State after = State::kNotCreated;
    Stage stage = Stage::kOpen;
    bool is_taken_back = false;  // a goal, or a transaction, was
    bool is_already = false;     // where it is wanted
    bool has_waited = false;     // for what brought the task where it is wanted
    std::uint64_t command = 0;
  };
  struct Act {
    std::uint64_t id = 0;
    Signal signal = Signal::kOff;
    std::vector<Part> parts;
    Nanoseconds arrived;
    bool is_begun = false;
    bool has_failed = false;
    TaskId failed_at;
    std::string why;
  };
  enum class Verdict : std::uint8_t { kGo, kWait, kIllegal, kNoAnswer };

  bool takes_down(const Act& act) const noexcept { return act.signal == Signal::kOff || act.signal == Signal::kKill; }
  static std::vector<TaskId> tasks_of(const Act& act);
  bool is_revival(const Act& act, const Part& part) const noexcept;
  State state_for(const Act& act, TaskId task) const noexcept;
  Verdict judge(Act& act, Part& part) const;
  Verdict judge_taking_down(const Act& act, const Part& part, bool waits_for_rtpu) const;
  Nanoseconds due_for_rtpu(const Act& act, const Part& part) const noexcept;
  void take_back(Act& act);
  bool try_begin(Act& act);
  void begin(Act& act);
  void revive(Act& act, Part& part);
  void send(Act& act);
  void look_at_goals(Act& act);
  void fail(Act& act, TaskId task, std::string why);
  bool try_finish(Act& act);

  Situation& at_;
  Goals& goals_;
  Transaction& transaction_;
  std::list<Act> acts_;
};

}  // namespace chimera::subsystem
