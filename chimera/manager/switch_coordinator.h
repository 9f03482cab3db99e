// SPDX-License-Identifier: Apache-2.0
// What the manager does for a switch of configurations: it judges the request, orders the switch from the real-time
// units, which carry it out and decide by themselves, and puts their parts together into one receipt.
// docs/formats/processes.md, docs/decisions/0045-a-switch-is-committed-by-the-rtpus.md.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "chimera/manager/manager_state.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/switch_agreement.h"
#include "chimera/runtime/switch_receipt.h"

namespace chimera::manager {

/// What became of a request. The lists of `receipt` are those beside it.
struct SwitchOutcome {
  SwitchReceipt receipt;
  std::vector<TaskPart> tasks;
  std::vector<VariablePart> variables;
  std::string asked_by;
  std::string under_way;  ///< of NoSwitch::kUnderWay: which, asked for by whom
};
using Switched = std::function<void(const SwitchOutcome&)>;

/// The status word of a task of a unit that is dead, as it would be had the unit lived to make a change that was
/// committed without it: what comes back is the set after the switch. Context: setup.
TaskStatus last_status(const ManagerState& world, TaskId task);

/// Context: setup; never blocks. One request at a time.
class SwitchCoordinator {
 public:
  explicit SwitchCoordinator(ManagerState& world);

  /// Asks for a switch to a configuration. `switched` is called when it is over, maybe at once. `asked_by`: a role and
  /// user, or a task.
  void ask(const SwitchRequest& request, std::string asked_by, Nanoseconds wait, Nanoseconds now, Switched switched) {
    ask(request, tasks_of(world_.spec(), request.set), std::move(asked_by), wait, now, std::move(switched));
  }
  /// The same to any set of tasks that is legal; request.set is its number or kNoSet.
  void ask(const SwitchRequest& request, const TaskBits& target, std::string asked_by, Nanoseconds wait,
           Nanoseconds now, Switched switched);
  /// Aborts what is under way and not committed; false: there is nothing.
  bool cancel();
  bool is_under_way() const noexcept { return present_.has_value(); }
  /// One that is asked for now would not be refused as under way; of a manager before this one neither.
  bool is_free() const noexcept;
  /// The switch that is under way is to that set.
  bool leads_to(std::uint32_t set) const noexcept { return present_ && present_->order.after == set; }
  /// "switch 3 to 'hand', asked for by operate:ann"; "" without one.
  std::string under_way() const;

  /// Deals with what the units have said since.
  void look(Nanoseconds now);
  /// When look() is due though nobody says anything; kNever: not.
  Nanoseconds next_due() const noexcept;

 private:
  struct Present {
    SwitchOrder order;
    SwitchRequest request;
    std::string asked_by;
    Nanoseconds asked, wait;
    std::uint32_t before = kNoSet;
    int tries = 1;
    bool is_cancelled = false;
    Switched switched;
  };

  SwitchAgreement agreement() const noexcept { return {world_.page.switching, world_.keeper.origin}; }
  /// When the plan that is open and not of this manager is past its deadline; kNever: there is none.
  Nanoseconds orphan_due() const noexcept;
  bool is_over(std::uint16_t number, std::uint16_t members) const noexcept;
  PlanAnswer judge(const TaskBits& target);
  SwitchOrder make_order(const TaskBits& target, Nanoseconds wait, Nanoseconds now);
  Nanoseconds lead() const noexcept;
  void announce(const SwitchOrder& order);
  SwitchOutcome collect(const Present& over, Nanoseconds now);
  void tell(const SwitchOutcome& outcome, Nanoseconds now);

  ManagerState& world_;
  HeapMemory memory_;  // behind the planner
  SwitchPlanner planner_;
  SwitchPlan plan_;
  std::vector<TaskStanding> standing_;  // by task, when a plan is judged
  std::optional<Present> present_;
};

}  // namespace chimera::manager
