// SPDX-License-Identifier: Apache-2.0
// Asks the kernel for the policy, level and CPUs of a thread.
#include "chimera/platform/thread_rights.h"

#include <sched.h>
#include <unistd.h>

namespace chimera {

static_assert(kPolicyOther == SCHED_OTHER && kPolicyFifo == SCHED_FIFO && kPolicyRoundRobin == SCHED_RR);

bool look_up_rights(pid_t thread, ThreadRights& rights) noexcept {
  sched_param param{};
  cpu_set_t set;
  CPU_ZERO(&set);
  const int policy = ::sched_getscheduler(thread);
  if (policy < 0 || ::sched_getparam(thread, &param) != 0 || ::sched_getaffinity(thread, sizeof set, &set) != 0)
    return false;
  rights = {thread, policy & ~SCHED_RESET_ON_FORK, param.sched_priority, -1};
  for (int cpu = 0; CPU_COUNT(&set) == 1 && cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &set)) rights.only_cpu = cpu;
  return true;
}

std::uint64_t page_bytes() noexcept { return static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)); }

}  // namespace chimera
