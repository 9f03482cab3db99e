// SPDX-License-Identifier: Apache-2.0
// Passes the latest value from one thread to another. No thread waits, and no value is half old.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace chimera::library {

/// Three places: the writer fills one, the reader reads one, the third is exchanged. One writer, one reader.
template <class T>
class Latest {
 public:
  /// Context: the writer's thread; wait-free.
  void put(const T& value) noexcept {
    places_[filled_] = value;
    // SYNC: pairs with get(): the value is complete before the exchange, and the reader has left the old place.
    filled_ = between_.exchange(filled_ | kFresh, std::memory_order_acq_rel) & kPlace;
  }
  /// Returns the last value put, T{} before the first. Valid until the next get(). Context: the reader's thread;
  /// wait-free.
  const T& get() noexcept {
    // SYNC: pairs with put().
    if ((between_.load(std::memory_order_relaxed) & kFresh) != 0)
      seen_ = between_.exchange(seen_, std::memory_order_acq_rel) & kPlace;
    return places_[seen_];
  }

 private:
  static constexpr std::uint32_t kPlace = 3, kFresh = 4;
  std::array<T, 3> places_{};
  std::atomic<std::uint32_t> between_{2};  // exchanges of put() and get() pair with each other
  std::uint32_t filled_ = 0, seen_ = 1;
};

}  // namespace chimera::library
