// SPDX-License-Identifier: Apache-2.0
// Passes rows of numbers from a cycle to a background method: one writer, one reader, no lock.
//
//   put (cycle)                                  take (background)
//   rows[put mod capacity] = row                 put (acquire) | use the row | taken = taken + 1 (release)
//   put = put + 1 (release)
// A row is refused only if capacity rows lie between taken and put.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace chimera::library {

class RowRing {
 public:
  /// Context: setup; may block.
  void make(std::size_t columns, std::size_t capacity) {
    columns_ = columns, capacity_ = capacity;
    rows_.assign(columns * capacity, 0.0);
  }
  std::size_t columns() const noexcept { return columns_; }

  /// Place for the next row, or nullptr without room. commit() publishes the row. Context: cycle; wait-free.
  double* begin() noexcept {
    const std::uint64_t put = put_.load(std::memory_order_relaxed);
    // SYNC: pairs with the release in release(): the reader has finished with the rows before taken_.
    if (put - taken_.load(std::memory_order_acquire) >= capacity_) return nullptr;
    return rows_.data() + put % capacity_ * columns_;
  }
  void commit() noexcept {
    // SYNC: pairs with the acquire in front(): the row is complete before it is counted.
    put_.store(put_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// The oldest row, or nullptr without one. It remains until release(). Context: background; wait-free.
  const double* front() const noexcept {
    const std::uint64_t taken = taken_.load(std::memory_order_relaxed);
    // SYNC: pairs with the release in commit().
    if (taken == put_.load(std::memory_order_acquire)) return nullptr;
    return rows_.data() + taken % capacity_ * columns_;
  }
  void release() noexcept {
    // SYNC: pairs with the acquire in begin(): the place of the row is free.
    taken_.store(taken_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

 private:
  std::size_t columns_ = 0, capacity_ = 0;
  std::vector<double> rows_;
  alignas(64) std::atomic<std::uint64_t> put_{0};    // written by cycle: release by commit, acquire by front
  alignas(64) std::atomic<std::uint64_t> taken_{0};  // written by background: release by release(), acquire by begin()
};

}  // namespace chimera::library
