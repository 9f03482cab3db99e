// SPDX-License-Identifier: Apache-2.0
// Memory and rights of the running rtpus, seen from outside: their resident memory, and the rights of their real-time
// threads compared with the granted ones. It costs the jobs no time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/platform/thread.h"

namespace chimera::manager {

/// The rights of an rtpu, read from its own report (RealtimeGrant::report).
struct GrantedRights {
  int level = 0;  ///< SCHED_FIFO; 0: ordinary
  int cpu = -1;   ///< pinned to; -1: any
  bool is_locked = false;

  static GrantedRights of(std::string_view report);
};

/// Rights that differ from the granted ones: "thread 4711 runs at SCHED_OTHER instead of SCHED_FIFO 80"; "" if none.
/// `threads`: the real-time threads at the start, with their present rights. A thread whose levels change with its jobs
/// (`preemptive`) may have any level up to the granted one.
std::string lost_rights(const GrantedRights& granted, bool preemptive, const std::vector<ThreadRights>& threads,
                        bool is_locked);

/// Updates the records of the rtpus and logs events. `memory`: an rtpu has more than twice the memory that it had when
/// it was ON, and 64 MB more; again after each further doubling. `rights`: it lost or gained rights, seen twice in a
/// row. Context: setup; reads some files of the kernel for each rtpu.
class RtpuHealth {
 public:
  explicit RtpuHealth(ManagerState& state) : state_(state), seen_(state.rtpus.size()) {}

  /// Call it often. It checks twice a second, and each rtpu when it comes up, before its tasks are ON.
  void look(Nanoseconds now);

 private:
  struct Seen {
    std::uint32_t incarnation = 0;
    std::vector<pid_t> threads;  // threads that were real-time or pinned when it came up
    Nanoseconds up_at;
    std::uint64_t told_bytes = 0;  // memory at the last report; 0: unknown
    std::string suspected;         // lost rights that were seen once
  };
  void meet(std::size_t index, Nanoseconds now);
  void weigh(std::size_t index, Nanoseconds now);
  void compare(std::size_t index, Nanoseconds now);

  ManagerState& state_;
  std::vector<Seen> seen_;
  Nanoseconds due_;
};

}  // namespace chimera::manager
