// SPDX-License-Identifier: Apache-2.0
// The three-state mutex over a futex (Drepper, Futexes Are Tricky, 2011, section 5).
#include "chimera/platform/section.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace chimera {

void Section::enter_taken() noexcept {
  times_taken_.fetch_add(1, std::memory_order_relaxed);
  while (word_.exchange(kWanted, std::memory_order_acquire) != kFree)
    ::syscall(SYS_futex, &word_, FUTEX_WAIT_PRIVATE, kWanted, nullptr, nullptr, 0);
}

void Section::wake_one() noexcept { ::syscall(SYS_futex, &word_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0); }

}  // namespace chimera
