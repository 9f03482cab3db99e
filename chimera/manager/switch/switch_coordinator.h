// SPDX-License-Identifier: Apache-2.0
// The manager's part in a switch of configurations. SwitchOrders (runtime/switch/switch_orders.h) judges the request,
// orders the switch from the rtpus and collects the receipt. This class answers the clients, files the receipt, and
// keeps the data that a successor needs in the journal. docs/formats/processes.md,
// docs/decisions/0045-a-switch-is-committed-by-the-rtpus.md.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chimera/manager/state/asker.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/manager/state/switch_journal.h"
#include "chimera/manager/switch/receipt_archive.h"
#include "chimera/manager/switch/switch_members.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/plan/slow_plan.h"

namespace chimera::manager {

/// Result of a request. The lists of `receipt` point to the vectors beside it.
struct SwitchOutcome {
  SwitchReceipt receipt;
  std::vector<TaskPart> tasks;
  std::vector<VariablePart> variables;
  std::vector<TaskId> reinitialised;
  std::string remedy;  ///< for a refusal; "": none is known
  std::string json;    ///< the filed receipt; "": there is none
};
using Switched = std::function<void(const SwitchOutcome&)>;

/// The switch that would happen now. Its lists point into the coordinator and are valid until its next call.
struct ForeseenSwitch {
  SwitchReceipt receipt;  ///< `before`, `after` and, for a refusal, `why`, `task` and `said`
  SwitchPlan plan;        ///< empty for a refusal
  std::string remedy;
  Nanoseconds expected;   ///< estimated time from the request to the change, without gaps, inputs and `safe_when`
  TaskId late_off;        ///< its `off` fits no gap: it comes IdleGap::kLongestWait late
  Nanoseconds needed;     ///< idle time that the `off` of late_off needs
};

/// Status word of a task of a dead rtpu. If a change was committed without the rtpu, the word is as if the rtpu had
/// made it. So the tasks that come back are those of the set after the switch. Context: setup.
TaskStatus last_status(const ManagerState& state, TaskId task);
/// Aborts an open plan in which the dead rtpu takes part. Call it before last_status(): otherwise the plan might be
/// committed after the last states were read. Context: setup; lock-free.
void abort_open_plan_of(ManagerState& state, RtpuId rtpu);

/// Context: setup; never blocks. One request at a time.
class SwitchCoordinator {
 public:
  /// Continues the switch that a predecessor has begun.
  SwitchCoordinator(ManagerState& state, ReceiptArchive& archive);

  /// Requests a switch to sets[request.set]. `asked_by`: the person; it has no role if a task or reaction asked, which
  /// the request names. Calls `switched` when the switch is over and its receipt is filed, maybe at once.
  void ask(const SwitchRequest& request, Asker asked_by, Nanoseconds wait, Nanoseconds now, Switched switched) {
    ask(request, tasks_of(state_.spec(), request.set), asked_by, wait, now, std::move(switched));
  }
  /// Requests a switch to any legal set of tasks; request.set is its number or kNoSet.
  void ask(const SwitchRequest& request, TaskBits target, Asker asked_by, Nanoseconds wait, Nanoseconds now,
           Switched switched);
  /// The result that ask() would have. Changes nothing.
  ForeseenSwitch foresee(TaskBits target);
  /// Aborts a switch that is under way and not committed. `switched` gets the same receipt as the requester. False if
  /// there is none or it is too late.
  bool cancel(Asker cancelled_by, Switched switched);
  bool is_under_way() const noexcept { return present_.has_value(); }
  /// True if a new request would not be refused because of a switch under way, of this manager or an earlier one.
  bool is_free() const noexcept;
  /// True if the requested switch is under way.
  bool leads_to(const SwitchRequest& request) const noexcept { return present_ && present_->begun.leads_to(request); }
  /// "switch 3 to 'hand', asked for by operate:ann", or "by task law", or "by on_fault of law"; "" if there is none.
  std::string under_way() const;
  /// The phase of the switch and its time limit: "arming, until 14:03:07". Requires: is_under_way().
  std::string progress() const;

  /// Handles the progress of the rtpus since the last call.
  void look(Nanoseconds now);
  /// The rtpus that must be killed, so that the switch ends: all others have waited in vain for one of their steps.
  std::vector<RtpuId> overdue(Nanoseconds now);
  /// Remedy for a refusal: the command that ends an rtpu which hangs; `otherwise` if none does.
  std::string way_out(const std::string& otherwise = "ask again when it is over") const;
  /// Time when look() is due if no bell rings; kNever: not due.
  Nanoseconds next_due() const noexcept;

 private:
  struct Present {
    BegunSwitch begun;
    std::vector<Switched> switched;  // empty: the request came to a predecessor
    Nanoseconds damaged_at = kNever;  // the first time that the page was found overwritten
    std::uint64_t words = 0;          // those by which the rtpus show their progress
    Nanoseconds moved_at{};           // they changed last
  };

  SwitchAgreement agreement() const noexcept { return orders_.agreement(); }
  void take_over();
  void announce();
  void look_at_page(Nanoseconds now);
  std::vector<RtpuId> held_up_by();
  std::uint64_t words_of_progress() const;
  Nanoseconds overdue_at() const noexcept;
  void assess(TaskBits& target, SwitchOutcome& outcome);
  Nanoseconds expected();
  void find_late_off(ForeseenSwitch& foreseen) const;
  bool is_tried_again(const SwitchReceipt& receipt, Nanoseconds now);
  std::shared_ptr<SwitchOutcome> collect(const BegunSwitch& over, Nanoseconds now);
  void file(std::shared_ptr<SwitchOutcome> outcome, const BegunSwitch& of, Nanoseconds now,
            std::vector<Switched> switched);
  void tell(const SwitchOutcome& outcome, Nanoseconds now);

  ManagerState& state_;
  ReceiptArchive& archive_;
  SwitchJournal journal_;
  HeapMemory memory_;  // memory of orders_ and slow_
  ShownMembers members_;
  SwitchOrders orders_;
  SlowPlanner slow_;
  std::optional<Present> present_;
  std::optional<SwitchOrder> last_;  // announced last; none: not known, since it was before this manager
  PlanWord last_plan_;               // of last_, as it was seen last
};

}  // namespace chimera::manager
