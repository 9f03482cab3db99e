// SPDX-License-Identifier: Apache-2.0
// Carries out a switch among configurations in one context while its tasks cycle. All or nothing, in this order:
//
//   plan     made from the order on the page that all contexts share (switch/switch_orders.h writes it)
//            waits until `safe_when` of the set holds
//   arm      `on` of each arriving task, producers first, beside its predecessor: the task reads the producers that are
//            armed before it and else the present ones, takes over the outputs that stand, writes into its own group
//            on failure: `off` of the armed tasks, which no other task has read
//   agree    the last context to arm proposes the instant T of the change; a context agrees if it has used no release
//            from T on; the last one to agree commits
//            on failure (late, or a member died): as above
//   change   jobs released before T keep what they read and write; from T on arriving tasks are ON, leaving ones are
//            OFF, readers read the new ones (changeover.h)
//   after    when all contexts have changed: `off` of each leaving task, against the data flow; the first cycles are
//            measured for the receipt
//
// A switch that cannot be made so goes the slow way: runtime/switch/slow_switch.h.
//
// Until all contexts have changed, no signal turns another task ON, so that a variable never has two producers.
//
// `on` and `off` run while the processor is idle (idle_gap.h); where jobs preempt each other they run at the urgency of
// the task (job_threads.h). Jobs take no part: each step is an act of a cycle boundary.
// docs/design/switch.md, docs/decisions/0045-a-switch-is-committed-by-the-rtpus.md.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "chimera/runtime/job/miss_policy.h"
#include "chimera/runtime/life/settlement.h"
#include "chimera/runtime/plan/idle_gap.h"
#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/record/context_tap.h"
#include "chimera/runtime/switch/arming.h"
#include "chimera/runtime/switch/changeover.h"
#include "chimera/runtime/switch/slow_switch.h"
#include "chimera/runtime/switch/switch_peers.h"
#include "chimera/runtime/switch/switch_record.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; as long as the methods of components take; no allocation but
/// theirs.
class Switching {
 public:
  /// The parts that a switch works on; all of them outlive this.
  struct Parts {
    TaskSet& set;
    ReadyQueue& queue;
    JobThreads& threads;
    Members& members;
    Settlement& settlement;
    ContextTap& tap;
    MissPolicy& misses;
    JobClock& clock;
  };
  explicit Switching(const Parts& parts) noexcept;
  /// Takes memory for the switches that the peers, which outlive this, say are ordered; null: there will be none.
  /// Context: setup.
  void prepare(SwitchPeers* peers);
  /// Instants on the page count from `origin`, that of the grid of releases.
  void begin(Nanoseconds origin) noexcept;

  /// Passes the request of a task on to what orders switches. False: it changes nothing. Requires: peers.
  bool ask(const SwitchRequest& request, Nanoseconds now) noexcept;
  /// A switch of which only the first cycles of arriving tasks are awaited is over: another one is to begin.
  void stop_watching(Nanoseconds now) noexcept;
  /// No switch is under way, or only the first cycles of arriving tasks are awaited.
  bool is_free() const noexcept;
  /// Goes on with the switch that is under way, or takes up the plan on the page. No effect without one.
  void step(Nanoseconds edge) noexcept;
  /// The order of a switch that was announced, until all contexts have changed or its abort is seen here; none: no
  /// switch is under way. keeps_out() in arming.h says which signals are refused until then. Wait-free.
  std::optional<SwitchOrder> under_way() const noexcept;
  /// A task is to go ON in place of a failed one: aborts a switch that is not committed. False: the change is under
  /// way, or the plan was not taken up yet.
  bool give_way(TaskId to) noexcept;
  /// The run is over: aborts a switch that is not committed, finishes one that is.
  void end(Nanoseconds now) noexcept;

  /// From this instant on a step may have something to do; kNever: only when other contexts ring. `in_row`: jobs wait,
  /// and none is under way at a cycle boundary. A step that is due at the end of each job is then due when no job waits
  /// any more, or before the next release, because a step takes time for each task. Wait-free.
  Nanoseconds due(bool in_row = false) const noexcept { return in_row && waits_for_row_ ? kNever : due_; }
  /// The next instant at which a step is due if no job ends before. Wait-free.
  Nanoseconds wake() const noexcept { return wake_; }

 private:
  enum class Phase : std::uint8_t { kNone, kArming, kAgreed, kChanging, kAfter, kUndoing, kSlow };

  SwitchAgreement agreement() const noexcept { return {peers_->page(), origin_}; }
  void take_up(const PlanWord& plan, Nanoseconds now) noexcept;
  void go_slowly(Nanoseconds now) noexcept;
  void arm(Nanoseconds edge, Nanoseconds now) noexcept;
  bool has_gap(const Task& next, Method method, Nanoseconds now) noexcept;
  bool arm(Task& next, Nanoseconds now) noexcept;
  bool may_go_on(Nanoseconds now) noexcept;
  void propose(Nanoseconds now) noexcept;
  void agree(Nanoseconds now) noexcept;
  void change(Nanoseconds now) noexcept;
  void abort(NoSwitch why, TaskId of, VariableId variable) noexcept;
  void settle(Nanoseconds now) noexcept;
  bool turn_off_all(Nanoseconds now, bool at_once) noexcept;
  void finish(SwitchEnd end, Nanoseconds now) noexcept;
  void wait(Nanoseconds now, Nanoseconds at_most = kNever) noexcept;
  Task& task(TaskId id) noexcept { return parts_.set.tasks()[id.index]; }

  Parts parts_;
  IdleGap gap_;
  Changeover changeover_;
  SlowSwitch slow_;
  SwitchRecord record_;
  SwitchPlanner planner_;
  SwitchPeers* peers_ = nullptr;      // null: nothing is switched
  SwitchOrder order_;
  SwitchPlan plan_;
  UndisturbedState before_;
  std::span<TaskStatus> statuses_;  // by task, when a plan is made
  Nanoseconds origin_, at_ = kNever;
  Nanoseconds gap_since_ = kNever;    // a gap is awaited
  Nanoseconds off_since_ = kNever;    // `off` of the first task is due
  Nanoseconds due_ = kNever, wake_ = kNever;
  std::uint32_t me_ = 0;              // number of this context
  std::size_t next_armed_ = 0;        // arriving tasks before it are armed, here or elsewhere
  std::size_t n_off_ = 0;
  std::uint16_t seen_ = 0;            // number of the last plan that was taken up
  Phase phase_ = Phase::kNone;
  bool waits_for_row_ = false;        // due_ is now for the end of jobs alone
  bool is_held_ = false;              // changeover_ is between hold() and release()
  bool is_changed_ = false;           // changeover_ has made the change
};

}  // namespace chimera
