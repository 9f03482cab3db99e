// SPDX-License-Identifier: Apache-2.0
// Waits and wakes by futex.
#include "chimera/platform/doorbell.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <ctime>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

static_assert(std::atomic<std::uint32_t>::is_always_lock_free && sizeof(std::atomic<std::uint32_t>) == 4);

// Without FUTEX_PRIVATE_FLAG the word is known by its page in every process that maps it, else by its address.
long futex(const std::atomic<std::uint32_t>* word, Ringers ringers, int operation, std::uint32_t value,
           const timespec* until) noexcept {
  const int scope = ringers == Ringers::kThisProcess ? FUTEX_PRIVATE_FLAG : 0;
  return ::syscall(SYS_futex, word, operation | scope, value, until, nullptr, FUTEX_BITSET_MATCH_ANY);
}

}  // namespace

void Doorbell::ring() const noexcept {
  word_->fetch_add(1, std::memory_order_release);  // pairs with read(): what was written before
  futex(word_, ringers_, FUTEX_WAKE, INT_MAX, nullptr);
}

WaitEnd Doorbell::wait_until(std::uint32_t seen, Nanoseconds instant) const noexcept {
  if (instant.count < 0) return WaitEnd::kReached;  // the kernel takes no negative time
  const timespec t{instant.count / 1'000'000'000, instant.count % 1'000'000'000};
  if (futex(word_, ringers_, FUTEX_WAIT_BITSET, seen, instant == kNever ? nullptr : &t) == 0) return WaitEnd::kWoken;
  CHIMERA_ASSERT(errno == ETIMEDOUT || errno == EAGAIN || errno == EINTR);
  return errno == ETIMEDOUT ? WaitEnd::kReached : WaitEnd::kWoken;
}

}  // namespace chimera
