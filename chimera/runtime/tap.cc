// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/tap.h"

#include "chimera/base/assert.h"

namespace chimera {

Tap::Tap(std::span<TapRecord> ring) noexcept : ring_(ring) {
  CHIMERA_ASSERT(ring.size() >= 2 && (ring.size() & (ring.size() - 1)) == 0);
}

std::size_t Tap::read(std::span<TapRecord> out) noexcept {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  // SYNC: pairs with the release in append(): records below head are whole.
  const std::uint64_t head = head_.load(std::memory_order_acquire);
  std::size_t n = 0;
  for (; n < out.size() && tail + n < head; ++n) out[n] = ring_[(tail + n) & (ring_.size() - 1)];
  // SYNC: pairs with the acquire in append(): the copies above are done before the slots are free.
  tail_.store(tail + n, std::memory_order_release);
  return n;
}

}  // namespace chimera
