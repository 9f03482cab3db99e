// SPDX-License-Identifier: Apache-2.0
// A lock for short, bounded pieces of code. Where its users run at one real-time level on one CPU nobody ever finds it
// taken and it costs two atomic operations; elsewhere (no real-time rights, a sanitizer) it is what excludes.
#pragma once

#include <atomic>
#include <cstdint>

namespace chimera {

/// Not recursive. Whoever holds it neither blocks nor faults.
class Section {
 public:
  /// Context: cycle; wait-free while it is free, else blocks.
  void enter() noexcept {
    std::uint32_t free = kFree;
    if (!word_.compare_exchange_strong(free, kTaken, std::memory_order_acquire)) enter_taken();
  }
  /// Context: cycle; wait-free.
  void leave() noexcept {
    if (word_.exchange(kFree, std::memory_order_release) == kWanted) wake_one();
  }
  /// How often somebody found it taken. Context: any; wait-free.
  std::uint64_t times_taken() const noexcept { return times_taken_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::uint32_t kFree = 0, kTaken = 1, kWanted = 2;  // wanted: taken, and somebody sleeps

  void enter_taken() noexcept;
  void wake_one() noexcept;

  // The release of leave() pairs with the acquire of enter() and enter_taken(): what one user wrote the next one sees.
  std::atomic<std::uint32_t> word_{kFree};
  std::atomic<std::uint64_t> times_taken_{0};  // relaxed: a figure that pairs with nothing
};

}  // namespace chimera
