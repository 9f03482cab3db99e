// SPDX-License-Identifier: Apache-2.0
// What the manager does for a switch of configurations: SwitchOrders (runtime/switch/switch_orders.h) judges the
// request, orders the switch from the rtpus and collects the receipt; this class answers the people who ask, files the
// receipt, and keeps in the journal what a successor needs to go on. docs/formats/processes.md,
// docs/decisions/0045-a-switch-is-committed-by-the-rtpus.md.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chimera/manager/asker.h"
#include "chimera/manager/manager_state.h"
#include "chimera/manager/receipt_archive.h"
#include "chimera/manager/switch_journal.h"
#include "chimera/manager/switch_members.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/switch/slow_plan.h"

namespace chimera::manager {

/// What became of a request. The lists of `receipt` are those beside it.
struct SwitchOutcome {
  SwitchReceipt receipt;
  std::vector<TaskPart> tasks;
  std::vector<VariablePart> variables;
  std::vector<TaskId> reinitialised;
  std::string remedy;  ///< of a refusal; "": none is known
  std::string json;    ///< the receipt as it is filed; "": there is none
};
using Switched = std::function<void(const SwitchOutcome&)>;

/// What a switch would do now. Lists point into the coordinator, until it is asked for anything else.
struct ForeseenSwitch {
  SwitchReceipt receipt;  ///< `before`, `after` and, where it would be refused, `why`, `task` and `said`
  SwitchPlan plan;        ///< empty where it would be refused
  std::string remedy;
  Nanoseconds expected;   ///< from the request to the change, about; gaps, inputs and `safe_when` come on top
  TaskId late_off;        ///< its `off` was never called and fits no gap, so it comes IdleGap::kLongestWait late
  Nanoseconds needed;     ///< by the `off` of late_off
};

/// The status word of a task of a unit that is dead, as it would be had the unit lived to make a change that was
/// committed without it: what comes back is the set after the switch. Context: setup.
TaskStatus last_status(const ManagerState& world, TaskId task);
/// Of a unit that is dead, before last_status(): an open plan in which it took part is aborted, else it might be
/// committed after its last states were read. Context: setup; lock-free.
void abort_open_plan_of(ManagerState& world, RtpuId rtpu);

/// Context: setup; never blocks. One request at a time.
class SwitchCoordinator {
 public:
  /// Takes up the switch that a predecessor has begun.
  SwitchCoordinator(ManagerState& world, ReceiptArchive& archive);

  /// Asks for a switch to sets[request.set]. `asked_by`: of a person; without a role of a task or reaction, which the
  /// request names. `switched` is called when it is over and its receipt is filed, maybe at once.
  void ask(const SwitchRequest& request, Asker asked_by, Nanoseconds wait, Nanoseconds now, Switched switched) {
    ask(request, tasks_of(world_.spec(), request.set), asked_by, wait, now, std::move(switched));
  }
  /// The same to any set of tasks that is legal; request.set is its number or kNoSet.
  void ask(const SwitchRequest& request, const TaskBits& target, Asker asked_by, Nanoseconds wait, Nanoseconds now,
           Switched switched);
  /// What ask() would do. Changes nothing.
  ForeseenSwitch foresee(const TaskBits& target);
  /// Aborts what is under way and not committed: `switched` gets the same receipt as who asked for it. False: there is
  /// nothing, or it is too late.
  bool cancel(Asker cancelled_by, Switched switched);
  bool is_under_way() const noexcept { return present_.has_value(); }
  /// One that is asked for now would not be refused as under way; of a manager before this one neither.
  bool is_free() const noexcept;
  /// What is asked for is under way.
  bool leads_to(const SwitchRequest& request) const noexcept { return present_ && present_->begun.leads_to(request); }
  /// "switch 3 to 'hand', asked for by operate:ann", or "by task law", or "by on_fault of law"; "" without one.
  std::string under_way() const;
  /// How far it is, and until when it may take: "arming, until 14:03:07". Requires: is_under_way().
  std::string progress() const;

  /// Deals with what the units have said since.
  void look(Nanoseconds now);
  /// When look() is due though nobody says anything; kNever: not.
  Nanoseconds next_due() const noexcept;

 private:
  struct Present {
    BegunSwitch begun;
    std::vector<Switched> switched;  // none: who asked, asked a predecessor
  };

  SwitchAgreement agreement() const noexcept { return orders_.agreement(); }
  void take_over();
  void assess(const TaskBits& target, SwitchOutcome& outcome);
  Nanoseconds method_time(TaskId task, Method method) const;
  Nanoseconds expected();
  void find_late_off(ForeseenSwitch& foreseen) const;
  bool is_tried_again(const SwitchReceipt& receipt, Nanoseconds now);
  std::shared_ptr<SwitchOutcome> collect(const BegunSwitch& over, Nanoseconds now) const;
  void file(std::shared_ptr<SwitchOutcome> outcome, const BegunSwitch& of, Nanoseconds now,
            std::vector<Switched> switched);
  void tell(const SwitchOutcome& outcome, Nanoseconds now);

  ManagerState& world_;
  ReceiptArchive& archive_;
  SwitchJournal journal_;
  HeapMemory memory_;  // behind orders_ and slow_
  ShownMembers members_;
  SwitchOrders orders_;
  SlowPlanner slow_;
  std::optional<Present> present_;
};

}  // namespace chimera::manager
