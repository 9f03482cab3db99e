// SPDX-License-Identifier: Apache-2.0
// Brings tasks back that failed, at cycle boundaries of one context and without a request. It turns standbys ON in
// place of tasks that failed here or elsewhere; runtime/plan/standbys.h chooses them. Hot standbys cycle before that.
// It also carries out the reaction `restart` of on_fault. A standby that needs a resource of the failed task is created
// after that task is killed, or its process is dead. A failed task that has a standby is replaced first; `restart` then
// only clears it, and it stays OFF.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "chimera/runtime/cycle/boundary_signals.h"
#include "chimera/runtime/cycle/takeover_record.h"
#include "chimera/runtime/life/settlement.h"
#include "chimera/runtime/life/task_set.h"
#include "chimera/runtime/plan/idle_gap.h"
#include "chimera/runtime/switch/switching.h"

namespace chimera {

/// Context of everything not marked: cycle boundary; as long as the methods of components take; no allocation but
/// theirs.
class Recovery {
 public:
  /// All parts outlive Recovery.
  struct Parts {
    TaskSet& set;
    Settlement& settlement;
    Switching* switching;  ///< null: nothing is switched
    BoundarySignals& signals;
    ReadyQueue& queue;
    JobThreads& threads;
    BoundaryListener* guest;  ///< null: no report
  };
  explicit Recovery(const Parts& parts) noexcept
      : parts_(parts),
        gap_(parts.set.tasks(), parts.queue, parts.threads),
        record_(parts.set, parts.threads) {}
  /// Sets the peers that get the records of takeovers, which outlive this; null: none gets any. Context: setup.
  void prepare(SwitchPeers* peers);

  /// Does what is due. No effect if no task has a standby or is restarted.
  void act(Nanoseconds now) noexcept;
  /// The run is over: also reports takeovers that still wait for a first cycle.
  void end(Nanoseconds now) noexcept { record_.look(now, true); }
  /// The first instant at which act() may have something to do although no state has changed; kNever: none. Wait-free.
  Nanoseconds due() const noexcept { return std::min(parts_.set.standbys().due(), due_); }
  /// The first such instant even if no job ends before. Wait-free.
  Nanoseconds wake() const noexcept { return std::min(parts_.set.standbys().due(), wake_); }

 private:
  /// The reaction of one task.
  struct Restart {
    const RestartSpec* spec = nullptr;
    std::uint32_t n = 0;       // restarts since the task last ran for `within` without a fault
    Nanoseconds last;          // instant of the last one
    bool is_answered = false;  // the task is in ERROR, and stays there
  };

  /// Takeover under way in one group.
  struct UnderWay {
    TaskId closes;         // its ERROR is to be seen in another context before it is killed here
    TaskId created;        // here; its `init` may be under way
    Nanoseconds again_at;  // when to call a standby again whose device was not ready
  };

  /// A standby that cycles beside the task that is ON.
  struct HotStandby {
    TaskId task;
    Nanoseconds again_at;  // when to call its `on` again, which was not ready
  };

  void keep_warm(Nanoseconds now) noexcept;
  void keep_warm(HotStandby& standby, Nanoseconds now) noexcept;
  void look_again(Nanoseconds at, Nanoseconds waking) noexcept;
  bool take_over(std::size_t group, Nanoseconds now) noexcept;
  bool give_up_resource(std::size_t group, TaskId to, Nanoseconds now) noexcept;
  bool create(std::size_t group, Task& task, Nanoseconds now) noexcept;
  bool turn_on(std::size_t group, Task& task, Nanoseconds now) noexcept;
  void rule_out(std::size_t group, Task& task, NoSwitch why, Nanoseconds now) noexcept;
  bool restart(Restart& restart, Nanoseconds now) noexcept;
  void answer(Restart& restart, Task& task, Nanoseconds now) noexcept;
  bool may_touch(Task& task) noexcept;
  void note(Task& task, const char* what, TaskId of) noexcept;

  Parts parts_;
  IdleGap gap_;
  TakeoverRecord record_;
  std::span<HotStandby> hot_;       // of this context
  std::span<UnderWay> takeovers_;  // by group
  std::span<Restart> restarts_;
  Nanoseconds due_ = kNever, wake_ = kNever;  // of standbys that cannot cycle, or go ON, yet
};

}  // namespace chimera
