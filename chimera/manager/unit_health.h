// SPDX-License-Identifier: Apache-2.0
// What real-time units take and give up while they run, seen from outside: their resident memory, and the rights of
// their real-time threads against what was granted. Jobs pay nothing for it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "chimera/manager/manager_state.h"
#include "chimera/platform/thread.h"

namespace chimera::manager {

/// What a unit was granted, read from what it says of itself (RealtimeGrant::report).
struct GrantedRights {
  int level = 0;  ///< SCHED_FIFO; 0: ordinary
  int cpu = -1;   ///< pinned to; -1: any
  bool is_locked = false;

  static GrantedRights of(std::string_view report);
};

/// What of `granted` is not in force any more, or is in force beyond it: "thread 4711 runs at SCHED_OTHER instead of
/// SCHED_FIFO 80"; "" when nothing. `threads`: the real-time threads at the start, as they are now; a thread whose
/// levels change with its jobs (`preemptive`) may have any level up to the granted one.
std::string lost_rights(const GrantedRights& granted, bool preemptive, const std::vector<ThreadRights>& threads,
                        bool is_locked);

/// Writes into the records of the rtpus, and tells events: `memory` when a unit has more than twice the memory that it
/// had when it was ON, and 64 MB more; again after each further doubling. `rights` when it lost or took some, seen
/// twice in a row. Context: setup; reads some files of the kernel for each unit.
class UnitHealth {
 public:
  explicit UnitHealth(ManagerState& world) : world_(world), seen_(world.rtpus.size()) {}

  /// To be called often: looks twice in a second, and at a unit when it comes up, before its tasks are ON.
  void look(Nanoseconds now);

 private:
  struct Seen {
    std::uint32_t incarnation = 0;
    std::vector<pid_t> threads;  // that were real-time or pinned when it came up
    Nanoseconds up_at;
    std::uint64_t told_bytes = 0;  // of memory; 0: not known yet
    std::string suspected;         // seen once
  };
  void meet(std::size_t index, Nanoseconds now);
  void weigh(std::size_t index, Nanoseconds now);
  void compare(std::size_t index, Nanoseconds now);

  ManagerState& world_;
  std::vector<Seen> seen_;
  Nanoseconds due_;
};

}  // namespace chimera::manager
