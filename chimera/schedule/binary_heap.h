// SPDX-License-Identifier: Apache-2.0
// A binary heap over given memory. The caller passes the order with each call, so keys may lie elsewhere.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

namespace chimera {

/// `before(a, b)`: a leaves the heap before b. Each call needs the same order. Context: cycle; wait-free; O(log n).
template <class T>
class BinaryHeap {
 public:
  explicit BinaryHeap(std::span<T> memory) noexcept : items_(memory) {}

  bool is_empty() const noexcept { return size_ == 0; }
  std::uint32_t size() const noexcept { return size_; }
  /// The item that leaves next. Requires: not empty.
  const T& top() const noexcept { return items_[0]; }
  /// All items, unordered. A caller that changes the key of an item must restore the order.
  std::span<const T> items() const noexcept { return {items_.data(), size_}; }

  /// Requires: room. Context of both functions: O(1).
  void set_only(const T& item) noexcept {
    items_[0] = item;
    size_ = 1;
  }
  void clear() noexcept { size_ = 0; }
  template <class Before>
  void push(const T& item, Before&& before) noexcept {
    items_[size_] = item;
    sift_up(size_++, before);
  }
  /// Restores the order after the key of the first item changed, so that it leaves later or at the same place.
  template <class Before>
  void sift_top(Before&& before) noexcept {
    sift_down(0, before);
  }
  /// Removes the item at that place of items(). Its key may have changed.
  template <class Before>
  void erase(std::uint32_t at, Before&& before) noexcept {
    if (at == --size_) return;
    items_[at] = items_[size_];
    sift_up(at, before);
    sift_down(at, before);
  }

 private:
  template <class Before>
  void sift_up(std::uint32_t at, Before&& before) noexcept {
    for (; at > 0 && before(items_[at], items_[(at - 1) / 2]); at = (at - 1) / 2)
      std::swap(items_[at], items_[(at - 1) / 2]);
  }
  template <class Before>
  void sift_down(std::uint32_t at, Before&& before) noexcept {
    for (;;) {
      std::uint32_t best = 2 * at + 1;
      if (best >= size_) return;
      if (best + 1 < size_ && before(items_[best + 1], items_[best])) ++best;
      if (!before(items_[best], items_[at])) return;
      std::swap(items_[at], items_[best]);
      at = best;
    }
  }

  std::span<T> items_;
  std::uint32_t size_ = 0;
};

}  // namespace chimera
