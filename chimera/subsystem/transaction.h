// SPDX-License-Identifier: Apache-2.0
// Turning tasks ON, all or none, one transaction at a time: that there are never two producers rests on it.
//
// Judged against the tasks that are, or for all we know may be, ON; sent run by run in data-flow order; when anything
// goes wrong, whoever is ON by it is turned OFF backwards. Its tasks have the goal `on` until it is over, so that the
// next manager goes on with it.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "chimera/subsystem/goals.h"
#include "chimera/subsystem/situation.h"

namespace chimera::subsystem {

/// Who wants which tasks ON.
struct OnWish {
  std::uint64_t id = 0;  ///< command of a face; 0: none
  std::vector<TaskId> tasks;
  TaskId from;           ///< the task that asked
  bool is_goals = false; ///< the goals themselves
};

/// Context: setup.
class Transaction {
 public:
  Transaction(Situation& situation, Goals& goals) : at_(situation), goals_(goals) {}

  bool is_under_way() const noexcept { return is_under_way_; }
  bool has(TaskId task) const noexcept;

  /// Judges and begins, or refuses. Requires: none is under way, no task of it is busy.
  void begin(OnWish wish);
  void take(const Reply& reply);
  /// A status word was read: has somebody left ON by itself?
  void look(TaskId task);
  /// A person wants the task OFF or killed and sees to that: the transaction fails; goals of the others stay.
  void withdraw(TaskId task, Signal signal);
  /// An rtpu died.
  void lose(RtpuId rtpu, const std::string& cause);

  /// Sends what is due, ends when all is over. To be called when anything above may have changed something.
  void advance();

  /// Answers a wish that did not become a transaction.
  void refuse(const OnWish& wish, TaskId at, std::string why);

 private:
  enum class Stage : std::uint8_t { kOpen, kSent, kOn, kOver };
  struct Member {
    TaskId task;
    State before = State::kOff;
    Stage stage = Stage::kOpen;
    bool is_withdrawn = false;  // somebody else turns it OFF
    std::uint64_t command = 0;
  };
  Member* find(TaskId task) noexcept;
  TaskId first_wrong(const OnWish& wish) const;
  void fail(TaskId at, std::string why, bool is_final);
  void roll_back();
  bool is_waiting() const noexcept;
  void finish();
  void answer(const OnWish& wish, TaskId at, std::string why, std::vector<Outcome> outcomes) const;

  Situation& at_;
  Goals& goals_;
  OnWish wish_;
  std::vector<Member> members_;
  std::vector<TaskId> already_;  // ON when a person wished for them: neither sent nor rolled back
  bool is_under_way_ = false;
  bool has_failed_ = false;
  bool is_final_ = false;  // the goals are given up with it
  bool is_rolling_back_ = false;
  TaskId failed_at_;
  std::string why_;
};

}  // namespace chimera::subsystem
