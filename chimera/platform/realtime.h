// SPDX-License-Identifier: Apache-2.0
// What a process needs of the machine to run in real time: scheduling rights, a CPU of its own, locked memory, and
// limits of the shell that are not too low. The system may accept a request and not follow it (a cgroup, an emulated
// kernel, a zero budget): enter_realtime() reads back which rights are in force.
#pragma once

#include <cstdint>
#include <string_view>

#include "chimera/base/fixed.h"
#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/platform/descriptor.h"

namespace chimera {

struct RealtimeRequest {
  int priority = 0;         ///< SCHED_FIFO 1..99; 0 leaves the thread as it is
  int cpu = -1;             ///< the only CPU to run on; -1: any
  bool lock_memory = true;  ///< keep all pages of the process in memory
  /// Bytes that the process maps later. Without room for them no page is locked: each later mapping would fail.
  std::uint64_t room = 0;
};

/// Words of RealtimeGrant::report. Other processes read the granted rights behind them.
inline constexpr std::string_view kLevelWords = "SCHED_FIFO ", kPinnedWords = "pinned to CPU ",
                                  kLockedWords = "memory locked", kRefusedWords = " refused",
                                  kMissingWords = "WARNING: not real time",
                                  kAskedWords = "ordinary scheduling was asked for",
                                  kUnboundWords = "no PREEMPT_RT in the kernel: nothing bounds the jitter";

/// The rights of a RealtimeRequest that are in force now. A right that was not requested counts as granted.
struct RealtimeGrant {
  bool priority = false;
  bool cpu = false;
  bool memory = false;
  /// Share of each period in which the kernel lets real-time threads run: 0.95 by default, 1 if not throttled.
  double throttle_share = 1;
  /// If all rights are granted: one line that names them, with kUnboundWords if they apply. Otherwise a line that
  /// begins with "WARNING"; below it, each in a line that begins with two spaces, the missing rights with the setting
  /// that gives them, and the granted rights.
  FixedString<400> report;

  bool is_complete() const noexcept { return priority && cpu && memory; }
};

/// Why a thread with that report is not real time, in one line; "" if it is. Context: any.
FixedString<400> not_real_time(std::string_view report) noexcept;

/// Applies `request` to the calling thread (memory: to the process), as far as the system allows. Without rights the
/// program still runs, but late. Threads and processes that the thread starts later are ordinary
/// (SCHED_RESET_ON_FORK). Context: setup; may block.
RealtimeGrant enter_realtime(const RealtimeRequest& request) noexcept;

/// The share of a CPU that the kernel leaves to real-time threads (sched_rt_runtime_us of sched_rt_period_us); 1: all.
/// Context: setup.
double realtime_share() noexcept;
/// The period of that share (sched_rt_period_us). Context: setup.
Nanoseconds realtime_period() noexcept;

/// True if the system grants SCHED_FIFO at `priority` to this user. The calling thread keeps its policy.
/// Context: setup.
bool may_be_realtime(int priority) noexcept;

/// The claim of a CPU for the SCHED_FIFO levels, one on the whole machine: priorities of two subsystems on one CPU are
/// not comparable, so both would lose their guarantees. Held until its end or the death of the process. Move-only. Not
/// inherited by exec. The claim is an abstract Unix socket "chimera-cpu-N": "machine" means one network namespace. A
/// locked file would stay behind or need a set-up. Any local user can bind the name first and so prevent a start at
/// real-time priorities, but cannot disturb a running subsystem.
class CpuClaim {
 public:
  /// Refuses a claimed CPU: names the process and user that hold the claim, and the remedy. Context: setup.
  static Result<CpuClaim> take(int cpu) noexcept;

  CpuClaim() noexcept = default;

  bool is_held() const noexcept { return descriptor_.fd >= 0; }

 private:
  explicit CpuClaim(OwnedDescriptor descriptor) noexcept : descriptor_(std::move(descriptor)) {}
  OwnedDescriptor descriptor_;
};

/// Refuses a limit of open files (ulimit -n, LimitNOFILE=) that leaves no room for `more` descriptors. Context: setup.
Result<void> may_open_here(std::uint64_t more) noexcept;

/// Refuse limits of the shell or the service (ulimit, LimitSTACK=) under which the process would die without a message:
/// a stack below 256 KiB, which every process needs; files below 4 MiB, which shared memory needs. Context: setup.
Result<void> may_run_here() noexcept;
Result<void> may_share_memory_here() noexcept;

}  // namespace chimera
