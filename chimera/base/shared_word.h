// SPDX-License-Identifier: Apache-2.0
// A word that several threads share, or that one context has for itself. A microcontroller without instructions for
// atomic changes, or for 64 bits, then needs no library for them.
#pragma once

#include <atomic>
#include <type_traits>
#include <utility>

#include "chimera/base/mechanisms.h"

namespace chimera {

/// The interface of std::atomic over a plain value. Context: one thread; wait-free.
template <class T>
class PlainWord {
 public:
  constexpr PlainWord() noexcept = default;
  constexpr PlainWord(T value) noexcept : value_(value) {}  // NOLINT: as std::atomic
  T load(std::memory_order) const noexcept { return value_; }
  void store(T value, std::memory_order) noexcept { value_ = value; }
  T fetch_or(T bits, std::memory_order) noexcept { return std::exchange(value_, static_cast<T>(value_ | bits)); }
  T fetch_and(T bits, std::memory_order) noexcept { return std::exchange(value_, static_cast<T>(value_ & bits)); }

 private:
  T value_{};
};

template <class T>
using SharedWord = std::conditional_t<mechanisms::kCopies, std::atomic<T>, PlainWord<T>>;

}  // namespace chimera
