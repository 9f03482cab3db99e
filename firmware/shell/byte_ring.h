// SPDX-License-Identifier: Apache-2.0
// A ring of bytes between one writer and one reader, of which one may be an interrupt.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace chimera::firmware {

/// Holds N - 1 bytes; N is a power of two. Needs no compare-and-swap, which a Cortex-M0+ does not have.
template <std::uint32_t N>
class ByteRing {
 public:
  static_assert(N >= 2 && (N & (N - 1)) == 0);

  /// False, with nothing changed, when full. By the writer. Context: any; wait-free.
  [[nodiscard]] bool try_push(std::uint8_t byte) noexcept {
    const std::uint32_t end = end_.load(std::memory_order_relaxed);
    if (free_from(end) == 0) return false;
    bytes_[end % N] = byte;
    end_.store(end + 1, std::memory_order_release);  // pairs with try_pop()
    return true;
  }
  /// False when empty. By the reader. Context: any; wait-free.
  [[nodiscard]] bool try_pop(std::uint8_t& byte) noexcept {
    const std::uint32_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    byte = bytes_[begin % N];
    begin_.store(begin + 1, std::memory_order_release);  // pairs with free_from()
    return true;
  }
  /// Bytes that can be pushed now, at least. By the writer. Context: any; wait-free.
  std::uint32_t free() const noexcept { return free_from(end_.load(std::memory_order_relaxed)); }
  /// Context: any; wait-free.
  bool is_empty() const noexcept {
    return begin_.load(std::memory_order_acquire) == end_.load(std::memory_order_acquire);
  }

 private:
  std::uint32_t free_from(std::uint32_t end) const noexcept {
    return N - 1 - (end - begin_.load(std::memory_order_acquire));
  }

  std::uint8_t bytes_[N] = {};
  std::atomic<std::uint32_t> begin_{0}, end_{0};  // numbers of the next bytes to pop and to push
};

}  // namespace chimera::firmware
