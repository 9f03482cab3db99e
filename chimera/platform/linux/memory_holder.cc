// SPDX-License-Identifier: Apache-2.0
// Clones a process that shares the memory of this one and outlives it.
#include "chimera/platform/memory_holder.h"

#include <linux/close_range.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <climits>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <ctime>

#include "chimera/platform/owned_descriptor.h"

namespace chimera {
namespace {

// Long enough for everybody who waits for the death to have seen it, short enough to leave nothing behind.
constexpr timespec kRespite{0, 10'000'000};

alignas(64) std::byte stack[16 * 1024];

// In the other process, with this one's memory and thread-local storage: nothing but system calls.
int outlive(void* pidfd) noexcept {
  const sched_param none{};
  ::syscall(SYS_sched_setscheduler, 0, SCHED_IDLE, &none);
  ::syscall(SYS_prctl, PR_SET_NAME, "memory-holder", 0, 0, 0);
  ::syscall(SYS_dup2, reinterpret_cast<std::intptr_t>(pidfd), 0);
  ::syscall(SYS_close_range, 1, UINT_MAX, 0);  // what is shared with the dead must close with them
  pollfd dead{0, POLLIN, 0};
  while (::syscall(SYS_poll, &dead, 1, -1) == 0) {
  }
  ::syscall(SYS_nanosleep, &kRespite, nullptr);
  ::syscall(SYS_exit_group, 0);
  return 0;
}

}  // namespace

bool start_memory_holder() noexcept {
  const OwnedDescriptor self(static_cast<int>(::syscall(SYS_pidfd_open, ::getpid(), 0)));
  if (self.fd < 0) return false;
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  void* const pidfd = reinterpret_cast<void*>(static_cast<std::intptr_t>(self.fd));  // NOLINT: a number all the way
  const int pid = ::clone(outlive, stack + sizeof stack, CLONE_VM, pidfd);           // its end is told to nobody
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return pid > 0;
}

}  // namespace chimera
