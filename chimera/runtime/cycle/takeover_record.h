// SPDX-License-Identifier: Apache-2.0
// Keeps the record of each takeover that is under way in one context: what `on` took, how far each variable moved, what
// was lost until the first cycle.
#pragma once

#include <span>

#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/plan/takeover.h"
#include "chimera/runtime/switch/switch_peers.h"
#include "chimera/runtime/switch/switch_record.h"

namespace chimera {

/// Records takeovers by standbys of its own context, one for each group at a time. Context of everything not marked:
/// cycle boundary; no allocation.
class TakeoverRecord {
 public:
  /// The set and the threads outlive this.
  TakeoverRecord(TaskSet& set, JobThreads& threads) noexcept : set_(set), threads_(threads), steps_(set) {}
  /// Sets the peers that get the records, which outlive this; null: none gets any. Context: setup.
  void prepare(SwitchPeers* peers);

  /// The standby is about to go ON in place of the task that failed in its group. The last values of that task are
  /// kept. No effect while the record of the two is open.
  void begin(std::size_t group, TaskId standby) noexcept;
  /// Sets the execution time of its `on`.
  void took(std::size_t group, Nanoseconds time) noexcept { open_[group].takeover.standby.on = time; }
  /// The standby is ON. The record waits for its first cycle.
  void done(std::size_t group, Nanoseconds now) noexcept;
  /// The standby cannot go ON.
  void failed(std::size_t group, NoSwitch why, Nanoseconds now) noexcept;
  /// Reports each takeover whose first cycle was seen, or has not come in time. With `is_last`: all of them.
  void look(Nanoseconds now, bool is_last) noexcept;
  /// Call look() until this instant at the end of each job; kNever: no record waits. Wait-free.
  Nanoseconds due() const noexcept { return due_; }

 private:
  struct Open {
    Takeover takeover;
    bool is_open = false;
    std::uint64_t cycles = 0, losses = 0;  // when it went ON
    Nanoseconds first_cycle_by = kNever;
  };

  std::uint32_t set_in_force(TaskId failed) const noexcept;
  void list_handovers(Takeover& takeover) noexcept;
  void tell(Takeover& takeover) noexcept;
  void end(Open& open, Nanoseconds now) noexcept;
  void close(std::size_t group, NoSwitch why, Nanoseconds now) noexcept;
  Task& task(TaskId id) noexcept { return set_.tasks()[id.index]; }

  TaskSet& set_;
  JobThreads& threads_;
  SwitchPeers* peers_ = nullptr;
  HandoverSteps steps_;
  StartDelays delays_;
  std::span<Open> open_;  // by group
  std::uint32_t n_told_ = 0;
  Nanoseconds due_ = kNever;
};

}  // namespace chimera
