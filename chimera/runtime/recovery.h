// SPDX-License-Identifier: Apache-2.0
// Brings back what failed in one context, at edges and without anybody being asked: turns standbys ON in place of tasks
// that failed here or elsewhere (runtime/standbys.h says which), has hot standbys cycle beside them before,
// and carries out the reaction `restart` of on_fault. A standby with a resource of the task that failed is created for
// it, when that one is killed, or its process is dead. A
// task that failed and has a standby is replaced first; restarted, it is only cleared then, and stays OFF.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "chimera/runtime/boundary_signals.h"
#include "chimera/runtime/settlement.h"
#include "chimera/runtime/switch/idle_gap.h"
#include "chimera/runtime/switch/switching.h"
#include "chimera/runtime/takeover_record.h"
#include "chimera/runtime/task_set.h"

namespace chimera {

/// Context of everything not marked: edge; as long as the methods of components take; no allocation but theirs.
class Recovery {
 public:
  /// All of it outlives this.
  struct Parts {
    TaskSet& set;
    Settlement& settlement;
    Switching& switching;
    BoundarySignals& signals;
    ReadyQueue& queue;
    JobThreads& threads;
    BoundaryListener* guest;  ///< null: nobody is told
  };
  explicit Recovery(const Parts& parts) noexcept
      : parts_(parts),
        gap_(parts.set.tasks(), parts.queue, parts.threads),
        record_(parts.set, parts.threads) {}
  /// Takeovers are told to the peers, which outlive this; null: they are not told. Context: setup.
  void prepare(SwitchPeers* peers);

  /// Does what is due. Of no effect where no task has a standby or is restarted.
  void act(Nanoseconds now) noexcept;
  /// The run is over: takeovers whose first cycle is waited for are told of.
  void end(Nanoseconds now) noexcept { record_.look(now, true); }
  /// From when on act() may have something to do although no state has changed; kNever: only then. Wait-free.
  Nanoseconds due() const noexcept { return std::min(parts_.set.standbys().due(), due_); }
  /// The next instant at which that is so although no job ends before. Wait-free.
  Nanoseconds wake() const noexcept { return std::min(parts_.set.standbys().due(), wake_); }

 private:
  /// The reaction of one task.
  struct Restart {
    const RestartSpec* spec = nullptr;
    std::span<Nanoseconds> done;  // instants of the last restarts, the oldest first
    bool is_answered = false;     // the task is in ERROR, and stays there
  };

  /// What is under way in one group.
  struct UnderWay {
    TaskId closes;         // its ERROR is to be seen in another context before it is killed here
    TaskId created;        // here; its `init` may be under way
    Nanoseconds again_at;  // a standby whose device is not ready is asked then
  };

  /// One that cycles beside the task that is ON.
  struct HotStandby {
    TaskId task;
    Nanoseconds again_at;  // its `on` was not ready: it is asked then
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
