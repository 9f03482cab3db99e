// SPDX-License-Identifier: Apache-2.0
// A queue of bytes between an interrupt and the program.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace chimera::bare {

/// One side adds, the other side takes: two threads, or an interrupt and the program. Needs no compare-and-swap, which
/// a Cortex-M0+ does not have. Context of everything: any; wait-free.
template <std::size_t kBytes>
class ByteRing {
  static_assert(kBytes != 0 && (kBytes & (kBytes - 1)) == 0, "a power of two");

 public:
  /// False if the ring is full.
  bool add(std::uint8_t byte) noexcept {
    const std::uint32_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kBytes) return false;
    bytes_[end % kBytes] = byte;
    end_.store(end + 1, std::memory_order_release);  // pairs with take()
    return true;
  }
  /// The oldest byte; -1 if the ring is empty.
  int take() noexcept {
    const std::uint32_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return -1;
    const std::uint8_t byte = bytes_[begin % kBytes];
    begin_.store(begin + 1, std::memory_order_release);  // pairs with add()
    return byte;
  }
  /// Bytes that can be taken now: for the side that takes, at least as many.
  std::size_t size() const noexcept {
    const std::uint32_t begin = begin_.load(std::memory_order_acquire);
    return end_.load(std::memory_order_acquire) - begin;
  }
  /// Bytes that fit in now: for the side that adds, at least as many.
  std::size_t free() const noexcept { return kBytes - size(); }

 private:
  std::atomic<std::uint32_t> begin_{0}, end_{0};  // they only grow; the ring index is the remainder
  std::array<std::uint8_t, kBytes> bytes_{};
};

}  // namespace chimera::bare
