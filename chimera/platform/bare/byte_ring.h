// SPDX-License-Identifier: Apache-2.0
// A queue of bytes between an interrupt and the program.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace chimera::bare {

/// One side adds, the other side takes; one of them may be an interrupt of the same processor.
/// Context of everything: any; wait-free.
template <std::size_t kBytes>
class ByteRing {
  static_assert(kBytes != 0 && (kBytes & (kBytes - 1)) == 0, "a power of two");

 public:
  /// False if the ring is full.
  bool add(std::uint8_t byte) noexcept {
    const std::uint32_t end = end_;
    if (end - begin_ == kBytes) return false;
    bytes_[end % kBytes] = byte;
    std::atomic_signal_fence(std::memory_order_seq_cst);
    end_ = end + 1;
    return true;
  }
  /// The oldest byte; -1 if the ring is empty.
  int take() noexcept {
    const std::uint32_t begin = begin_;
    if (begin == end_) return -1;
    const std::uint8_t byte = bytes_[begin % kBytes];
    std::atomic_signal_fence(std::memory_order_seq_cst);
    begin_ = begin + 1;
    return byte;
  }
  std::size_t size() const noexcept { return end_ - begin_; }
  /// Bytes that fit in now.
  std::size_t free() const noexcept { return kBytes - size(); }

 private:
  volatile std::uint32_t begin_ = 0, end_ = 0;  // they only grow; the ring index is the remainder
  std::array<std::uint8_t, kBytes> bytes_{};
};

}  // namespace chimera::bare
