// SPDX-License-Identifier: Apache-2.0
// The real-time rights and the memory of another process, as the kernel has them.
#pragma once

#include <sys/types.h>

#include <cstdint>

namespace chimera {

/// Policies of the Linux scheduler.
inline constexpr int kPolicyOther = 0, kPolicyFifo = 1, kPolicyRoundRobin = 2;

/// The rights of one thread.
struct ThreadRights {
  pid_t thread = 0;
  int policy = 0, level = 0;  ///< kPolicyOther, kPolicyFifo...; SCHED_RESET_ON_FORK is left out
  int only_cpu = -1;          ///< the one CPU that it may run on; -1: several
  bool operator==(const ThreadRights&) const noexcept = default;
};

/// False when there is no such thread. Context: setup.
bool look_up_rights(pid_t thread, ThreadRights& rights) noexcept;

/// Bytes in a page of memory. Context: any.
std::uint64_t page_bytes() noexcept;

}  // namespace chimera
