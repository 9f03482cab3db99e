// SPDX-License-Identifier: Apache-2.0
// Receipt of one switch of configurations, or of one takeover by a standby (runtime/plan/takeover.h): its tasks,
// instants, durations, lost cycles, and the step of each variable. docs/formats/receipt.md says what is printed of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>

#include "chimera/base/assert.h"
#include "chimera/base/fixed.h"
#include "chimera/base/setup_memory.h"
#include "chimera/base/time.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/runtime/plan/switch_request.h"
#include "chimera/runtime/plan/switch_way.h"

namespace chimera {

/// Appends one task to the list. Requires: room behind it, as SwitchReceipts provides.
inline void append(std::span<TaskId>& list, TaskId task) noexcept {
  list = {list.data(), list.size() + 1};
  list.back() = task;
}

/// The role of a task in a switch.
enum class TaskMove : std::uint8_t { kArrives, kLeaves, kStays };

/// One task of a switch. A method that was not called took -1 ns.
struct TaskPart {
  TaskId task;
  TaskMove move = TaskMove::kStays;
  Nanoseconds on{-1};
  Nanoseconds off{-1};
  std::uint64_t lost = 0;  ///< releases of its grid within the switch, while it was ON, without a completed cycle
  Nanoseconds delay{-1};         ///< longest start delay of its cycles within the switch (StartDelays); -1: no cycle
  Nanoseconds delay_before{-1};  ///< the longest of the run before it; -1: it had no cycle
};

/// The element of a variable that moved farthest, measured by its limit where there is one.
struct ValueStep {
  double size = 0;   ///< |after - before| of that element; NaN: one of the two is not a number
  double limit = 0;  ///< PortSpec::max_step there; 0: none
  bool is_known = false;   ///< false: texts, or no task had written a value
  bool is_beyond = false;  ///< some element moved farther than its limit

  constexpr bool operator==(const ValueStep&) const noexcept = default;
};

/// One variable that got another producer.
struct VariablePart {
  Handover handover;
  ValueStep step_of_on;    ///< from the last value of the old producer to the value that `on` of the new one wrote
  ValueStep step_of_cycle; ///< as step_of_on, to the value of the first cycle of the new producer
  ValueStep usual;         ///< the largest between two publications in a row of the old producer, until the change
};

/// The end of a switch.
enum class SwitchEnd : std::uint8_t {
  kDone,
  kAborted,      ///< begun and undone: tasks that were ON were not touched
  kRefused,      ///< nothing was begun
  kNothingToDo,  ///< the requested set was in force
};

/// How a switch or a takeover went. Instants are on the clock of the executor; kNever: not reached.
struct SwitchResult {
  SwitchEnd end = SwitchEnd::kDone;
  NoSwitch why = NoSwitch::kNone;  ///< of an end that is not kDone
  TaskId task;                     ///< of `why`
  VariableId variable;             ///< of `why`
  double value = 0;                ///< of `variable`, of kNotSafe; NaN: it had none
  Nanoseconds armed = kNever;   ///< `on` of the last arriving task had returned
  Nanoseconds at = kNever;      ///< the instant of the change
  Nanoseconds ended = kNever;   ///< `off` of the last leaving task had returned and the first cycles were seen
  Nanoseconds flag;             ///< how long the switch held the illegal-configuration flag up
  TaskId not_back;              ///< of kAborted: a task that was ON and did not come back
};

/// A new receipt is that of a refusal.
struct SwitchReceipt : SwitchResult {
  SwitchReceipt() noexcept { end = SwitchEnd::kRefused; }

  std::uint32_t number = 0;
  std::uint32_t before = kNoSet, after = kNoSet;  ///< in ApplicationSpec::sets
  TaskBits on_before;  ///< of a switch: ON at the request
  SwitchCause cause = SwitchCause::kScript;
  TaskId by;  ///< as SwitchRequest::by
  TaskId in_place_of;      ///< of kStandby: the task that failed
  bool was_death = false;  ///< of kStandby: its process died; else it is in ERROR
  FixedString<160> said;        ///< by `on` of `task`, of its fault
  Nanoseconds asked = kNever;   ///< as the instants of SwitchResult
  SwitchWay way;                ///< that the last try used
  std::uint32_t tries = 1;      ///< plans that were announced for it
  std::span<TaskPart> tasks;
  std::span<VariablePart> variables;
  std::span<TaskId> reinitialised;  ///< in this order
};

/// Fills in the request for a switch; the tasks `on` are ON, and the set `before` is in force.
inline void note_request(SwitchReceipt& receipt, const SwitchRequest& request, std::uint32_t before,
                         const TaskBits& on, const SwitchWay& way, Nanoseconds asked) noexcept {
  receipt.on_before = on;
  receipt.asked = asked;
  receipt.after = request.set;
  receipt.cause = request.cause;
  receipt.by = request.by;
  receipt.before = before;
  receipt.way = way;
}

/// Refuses a switch: nothing was begun. The answer gives the reason, or says that the set is already in force.
inline void refuse(SwitchReceipt& receipt, const PlanAnswer& answer) noexcept {
  receipt.end = answer.why == NoSwitch::kNothingToDo ? SwitchEnd::kNothingToDo : SwitchEnd::kRefused;
  receipt.why = answer.why;
  receipt.task = answer.task;
  receipt.way.slow = 0;
  receipt.tasks = {};
  receipt.variables = {};
}

/// Result of a switch in one context, as plain data in memory that outlives the context. `why` is of kAborted, where
/// this context aborted the plan; kNone: another one did.
/// Its owner writes it before SwitchProgress::over shows its number. Others read it after they saw that number, or
/// after the owner died. After a death it may hold anything, so a reader checks every number in it.
struct SwitchPart : SwitchResult {
  static constexpr std::uint32_t kVariablesKept = 64, kSaid = 160;

  std::uint32_t number = 0;         ///< of the plan; 0: it took part in none
  char said[kSaid + 1] = {};        ///< by `on` of `task`
  std::uint32_t n_reinitialised = 0;
  std::uint32_t n_tasks = 0;        ///< of this context, in `tasks`
  std::uint32_t n_variables = 0;    ///< handed over to tasks of this context; only kVariablesKept of them are kept
  std::array<TaskPart, kMaxSwitchedTasks> tasks;
  std::array<TaskId, kMaxSwitchedTasks> reinitialised;
  std::array<VariablePart, kVariablesKept> variables;
};

/// The part of the context whose tasks `is_mine` says are its own. Context: cycle boundary; wait-free.
template <class IsMine>
void write_part(const SwitchReceipt& receipt, IsMine is_mine, SwitchPart& part) noexcept {
  static_cast<SwitchResult&>(part) = receipt;
  std::memcpy(part.said, receipt.said.c_str(), receipt.said.view().size() + 1);
  part.n_tasks = part.n_variables = part.n_reinitialised = 0;
  for (const TaskId task : receipt.reinitialised) part.reinitialised[part.n_reinitialised++] = task;
  for (const TaskPart& task : receipt.tasks)
    if (is_mine(task.task)) part.tasks[part.n_tasks++] = task;
  for (const VariablePart& variable : receipt.variables) {
    if (!is_mine(variable.handover.to.task)) continue;
    if (part.n_variables < SwitchPart::kVariablesKept) part.variables[part.n_variables] = variable;
    ++part.n_variables;
  }
  part.number = receipt.number;
}

/// Reads the part as a receipt whose lists point into it. The lists must not be written, and any value may be wrong.
/// Context: setup.
inline void read_part(const SwitchPart& part, SwitchReceipt& receipt) noexcept {
  SwitchPart& lists = const_cast<SwitchPart&>(part);
  receipt = {};
  static_cast<SwitchResult&>(receipt) = part;
  receipt.number = part.number;
  const char* const end = std::find(part.said, part.said + SwitchPart::kSaid, '\0');
  receipt.said.assign({part.said, static_cast<std::size_t>(end - part.said)});
  receipt.tasks = std::span(lists.tasks).first(std::min<std::size_t>(part.n_tasks, part.tasks.size()));
  receipt.variables = std::span(lists.variables).first(std::min(part.n_variables, SwitchPart::kVariablesKept));
  receipt.reinitialised =
      std::span(lists.reinitialised).first(std::min<std::size_t>(part.n_reinitialised, part.reinitialised.size()));
}

/// Gets each receipt when its switch is over, where no list of all of them is kept.
class ReceiptReader {
 public:
  /// The receipt is gone afterwards. Context: cycle boundary.
  virtual void take(const SwitchReceipt& receipt) noexcept = 0;

 protected:
  ~ReceiptReader() = default;
};

/// The receipts of a run. If more are made than were planned for, the first ones and the last one are kept.
class SwitchReceipts {
 public:
  /// Takes memory for `n` receipts of this spec, above 0. Context: setup.
  void prepare(const ApplicationSpec& spec, std::size_t n, SetupMemory& memory) {
    all_ = memory.take<SwitchReceipt>(n);
    n_tasks_ = spec.tasks.size();
    n_variables_ = spec.variables.size();
    tasks_ = memory.take<TaskPart>(n * n_tasks_);
    reinitialised_ = memory.take<TaskId>(n * n_tasks_);
    variables_ = memory.take<VariablePart>(n * n_variables_);
  }
  /// The next receipt, empty but for its lists, which have their full length. Without room it replaces the last one.
  /// Context: cycle boundary; wait-free.
  SwitchReceipt& add() noexcept {
    CHIMERA_ASSERT(!all_.empty());
    if (has_room()) ++n_;
    else ++n_left_out_;
    const std::size_t at = n_ - 1;
    all_[at] = {};
    all_[at].tasks = tasks_.subspan(at * n_tasks_, n_tasks_);
    all_[at].reinitialised = reinitialised_.subspan(at * n_tasks_, 0);
    all_[at].variables = variables_.subspan(at * n_variables_, n_variables_);
    return all_[at];
  }
  bool has_room() const noexcept { return n_ < all_.size(); }
  /// Number of the next switch or takeover of the run, from 1, kept or not.
  std::uint32_t next_number() noexcept { return ++number_; }
  /// Forgets all that are kept. Context: cycle boundary.
  void clear() noexcept { n_ = 0; }
  /// Counts one more receipt that is not kept.
  void leave_out() noexcept { ++n_left_out_; }
  /// Number of receipts that were made and are not kept. Context: setup, between runs.
  std::uint64_t left_out() const noexcept { return n_left_out_; }
  /// Receipts in the order of their requests; the last switch may not have ended. Context: setup, between runs.
  std::span<const SwitchReceipt> all() const noexcept { return all_.first(n_); }

 private:
  std::span<SwitchReceipt> all_;
  std::span<TaskPart> tasks_;
  std::span<TaskId> reinitialised_;
  std::span<VariablePart> variables_;
  std::size_t n_ = 0, n_tasks_ = 0, n_variables_ = 0;
  std::uint64_t n_left_out_ = 0;
  std::uint32_t number_ = 0;
};

}  // namespace chimera
