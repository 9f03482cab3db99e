// SPDX-License-Identifier: Apache-2.0
// Decides about a switch of configurations: judges the request, makes the order that the contexts carry out, makes
// another try where that may help, and puts the parts of the contexts together into one receipt. The manager does this
// for processes (manager/switch/switch_coordinator.h), LocalSwitches for the contexts of one process.
//
//   judge -> make -> announce     the contexts arm, agree and change, or abort: runtime/switch/switching.h
//   is_over -> collect            what the contexts say becomes a receipt
//   make_next_try -> announce     where the switch was only late, or has to go the slow way
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/plan/constant_choice.h"
#include "chimera/runtime/plan/idle_gap.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/plan/switch_plan.h"
#include "chimera/runtime/plan/switch_receipt.h"
#include "chimera/runtime/plan/switch_way.h"
#include "chimera/task/profile.h"

namespace chimera {

/// A switch may take this time from the request to the change where the request does not say another one.
inline constexpr Nanoseconds kSwitchPatience = seconds(10);
/// Plans that are announced for one request, at most.
inline constexpr std::uint32_t kMostTries = 4;

/// View of the contexts that carry switches out, for SwitchOrders, and the way to reach them. Contexts are numbered as
/// rtpus; a context that is alone has number 0. Context of everything: cycle boundary, or setup in the manager.
class SwitchMembers {
 public:
  virtual SwitchPage& page() noexcept = 0;
  /// Bit c: context c lives, and takes part in the next switch.
  virtual std::uint16_t living() const noexcept = 0;
  virtual TaskStatus status(TaskId task) const noexcept = 0;
  /// A person turned the task OFF, and no person has turned it ON since.
  virtual bool is_kept_off(TaskId task) const noexcept = 0;
  /// Measurements of the task by its context; empty if they are not known.
  virtual Profile profile(TaskId task) const noexcept = 0;
  /// Methods of the task wait for an idle processor: jobs of its context do not preempt each other.
  virtual bool needs_gaps(TaskId task) const noexcept = 0;
  virtual const MadeConstants& constants() noexcept = 0;
  /// The context lives and is not over with that plan.
  virtual bool is_busy_with(std::uint32_t context, std::uint16_t plan) const noexcept = 0;
  /// The context's part of the receipt for that plan, in lists that `part` points at. False: none. Any value may be
  /// wrong.
  virtual bool read_part(std::uint32_t context, std::uint16_t plan, SwitchReceipt& part) const noexcept = 0;
  /// A word of the page changed: every context must check it.
  virtual void ring() noexcept = 0;

 protected:
  ~SwitchMembers() = default;
};

/// A switch that was ordered. Plain value, which the manager keeps in its journal.
struct OrderedSwitch {
  std::uint32_t number = 0;  ///< of its receipt
  std::uint32_t tries = 1;
  std::uint32_t before = kNoSet;
  SwitchCause cause = SwitchCause::kScript;
  TaskId by;  ///< as SwitchRequest::by
  Nanoseconds asked;
  SwitchWay way;      ///< of the last try, and why
  SwitchOrder order;  ///< of the last try

  /// The request asks for the tasks that this switch turns ON.
  bool leads_to(const SwitchRequest& request) const noexcept {
    return request.lists.are_there() ? request.lists.are_met_by(order.target) : order.after == request.set;
  }
};

/// Context of everything not marked: as SwitchMembers; no allocation.
class SwitchOrders : private NeededGaps {
 public:
  explicit SwitchOrders(SwitchMembers& members) noexcept : members_(members) {}
  /// The spec outlives this. `is_alone`: one context has all tasks, and agrees with itself at once. Context: setup.
  void prepare(const ApplicationSpec& spec, bool is_alone, SetupMemory& memory);
  /// Instants on the page count from `origin`, that of the grid of releases.
  void begin(Nanoseconds origin) noexcept { origin_ = origin; }

  SwitchAgreement agreement() const noexcept { return {members_.page(), origin_}; }
  /// Notes where the tasks stand now.
  void look() noexcept;
  /// Looks, and makes the plan and finds the way that leads to these tasks. A person's word and a takeover hold
  /// against a request of a task or reaction: a task that is kept OFF is refused, and in `target` a task that a standby
  /// has replaced becomes that standby.
  PlanAnswer judge(TaskBits& target, SwitchCause cause) noexcept;

  // Results of the last look() or judge().
  bool is_on(TaskId task) const noexcept { return statuses_[task.index].state == State::kOn; }
  TaskBits on() const noexcept { return tasks_on(statuses_); }
  std::uint32_t set_in_force() const noexcept { return planner_.set_in_force(statuses_); }
  const SwitchPlan& plan() const noexcept { return plan_; }
  const SwitchWay& way() const noexcept { return way_; }
  /// From the proposal of the instant of the change to that instant, in the first try.
  Nanoseconds lead() const noexcept;
  /// The set whose constants are in force: the one that was switched to last, at first that of the start.
  std::uint32_t constants_in_force() const noexcept;

  /// Fills in what judge() found for these tasks, and the order. Requires: judge() found a plan.
  void make(OrderedSwitch& next, const TaskBits& target, Nanoseconds until) const noexcept;
  void announce(const OrderedSwitch& next) noexcept;
  /// False: the plan is committed, or of another number.
  bool abort(const OrderedSwitch& present) noexcept;
  /// Finds the plan that the contexts made of that order. False: they made none.
  bool find_plan_of(const SwitchOrder& order) noexcept;
  /// Every context of `contexts` that lives is over with that plan.
  bool are_over(std::uint16_t plan, std::uint16_t contexts) const noexcept;
  /// Nothing is left to do for it.
  bool is_over(const OrderedSwitch& present) const noexcept {
    return !agreement().plan().is_open() && are_over(present.order.number, present.order.members);
  }
  /// Puts the parts together in `receipt`, whose lists have room for all tasks and variables. `otherwise`: why it was
  /// aborted if no context says so; kDamaged: the page was overwritten, so that only the tasks that look() found
  /// ON say how the switch ended. Instants after `now` are wrong.
  void collect(const OrderedSwitch& over, NoSwitch otherwise, Nanoseconds now, SwitchReceipt& receipt) const noexcept;
  /// Makes the next order of a switch that has ended with that reason: with more lead if it was only late, else the
  /// slow way. False: another try would not help. Requires: `why` is of collect().
  bool make_next_try(OrderedSwitch& over, NoSwitch why, Nanoseconds now) noexcept;

 private:
  Nanoseconds for_on(TaskId task) const noexcept override;
  TaskId heed_persons(TaskBits& target) const noexcept;
  Nanoseconds told_change(const OrderedSwitch& over, Nanoseconds otherwise) const noexcept;
  bool is_of(TaskId task, std::uint32_t context) const noexcept;
  void make_order(OrderedSwitch& next, const TaskBits& target, Nanoseconds until) const noexcept;
  void add_part(const SwitchReceipt& part, std::uint32_t context, Nanoseconds now, SwitchReceipt& to) const noexcept;
  void add_lists(const SwitchReceipt& part, std::uint32_t context, SwitchReceipt& to) const noexcept;

  SwitchMembers& members_;
  const ApplicationSpec* spec_ = nullptr;
  SwitchPlanner planner_;
  SwitchWays ways_;
  SwitchPlan plan_;
  SwitchWay way_;                     // of plan_
  std::span<TaskStatus> statuses_;  // by task
  Nanoseconds origin_;
  bool is_alone_ = false;
};

}  // namespace chimera
