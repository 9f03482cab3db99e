// SPDX-License-Identifier: Apache-2.0
// Containers of fixed capacity: no heap, so they may live on the cycle path and in shared memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "chimera/base/assert.h"

namespace chimera {

/// Text of at most N bytes. Longer text is cut at N. Trivially copyable.
/// Context: any; wait-free.
template <std::size_t N>
class FixedString {
 public:
  constexpr FixedString() noexcept = default;
  constexpr FixedString(std::string_view text) noexcept { assign(text); }  // NOLINT: text is text

  constexpr void assign(std::string_view text) noexcept {
    size_ = static_cast<std::uint16_t>(text.size() > N ? N : text.size());
    for (std::size_t i = 0; i < size_; ++i) bytes_[i] = text[i];
    bytes_[size_] = '\0';
  }
  constexpr std::string_view view() const noexcept { return {bytes_, size_}; }
  constexpr const char* c_str() const noexcept { return bytes_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  static constexpr std::size_t capacity() noexcept { return N; }

 private:
  static_assert(N > 0 && N < UINT16_MAX);
  char bytes_[N + 1] = {};
  std::uint16_t size_ = 0;
};

/// At most N values in place. Requires: T default-constructible. Context: any; wait-free.
template <class T, std::size_t N>
class FixedVector {
 public:
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  constexpr bool is_full() const noexcept { return size_ == N; }
  static constexpr std::size_t capacity() noexcept { return N; }

  /// Adds `value` at the end; false, with nothing changed, when full.
  [[nodiscard]] constexpr bool try_push(const T& value) noexcept {
    if (is_full()) return false;
    values_[size_++] = value;
    return true;
  }
  constexpr void clear() noexcept { size_ = 0; }
  constexpr void pop_back() noexcept { CHIMERA_ASSERT(size_ > 0); --size_; }
  constexpr T& operator[](std::size_t i) noexcept { CHIMERA_ASSERT(i < size_); return values_[i]; }
  constexpr const T& operator[](std::size_t i) const noexcept { CHIMERA_ASSERT(i < size_); return values_[i]; }
  constexpr T* begin() noexcept { return values_; }
  constexpr T* end() noexcept { return values_ + size_; }
  constexpr const T* begin() const noexcept { return values_; }
  constexpr const T* end() const noexcept { return values_ + size_; }

 private:
  T values_[N] = {};
  std::size_t size_ = 0;
};

}  // namespace chimera
