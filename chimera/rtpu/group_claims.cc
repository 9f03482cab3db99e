// SPDX-License-Identifier: Apache-2.0
// Takes and gives back the claims of one rtpu.
#include "chimera/rtpu/group_claims.h"

#include <utility>

namespace chimera {

// A claim of a dead process is free; so is a word that no rtpu would write.
bool GroupClaims::is_held(std::uint64_t claim) const noexcept {
  const std::uint64_t holder = claim >> 32;
  if (holder == 0 || holder > keeper_.n_rtpus || claim == mine_) return false;
  return keeper_.alive[holder - 1].load(std::memory_order_acquire) == static_cast<std::uint32_t>(claim);
}

bool GroupClaims::take(std::size_t group) noexcept {
  if (group >= kMaxGroups || keeper_.ending.load(std::memory_order_acquire) != 0) return false;
  std::atomic<std::uint64_t>& word = decision_.claims[group];
  std::uint64_t seen = word.load(std::memory_order_acquire);
  if (is_held(seen) || !word.compare_exchange_strong(seen, mine_, std::memory_order_acq_rel)) return false;
  return has_any_ = true;
}

void GroupClaims::give_back() noexcept {
  if (!std::exchange(has_any_, false)) return;
  for (std::atomic<std::uint64_t>& word : decision_.claims) {
    std::uint64_t mine = mine_;
    (void)word.compare_exchange_strong(mine, 0, std::memory_order_acq_rel);
  }
}

}  // namespace chimera
