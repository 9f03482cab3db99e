// SPDX-License-Identifier: Apache-2.0
// Text of fixed size, for ports: a std::string keeps its characters on a heap that other processes cannot read.
#pragma once

#include <cstddef>
#include <cstring>
#include <string_view>

namespace chimera {

/// N bytes of text: at most N - 1 characters, then zeros to the end. Longer text is cut.
/// Trivially copyable: crosses processes as it stands. Context: any; wait-free; O(N).
template <std::size_t N>
class Text {
 public:
  constexpr Text() noexcept = default;
  constexpr Text(std::string_view text) noexcept { assign(text); }        // NOLINT: text is text
  constexpr Text(const char* text) noexcept { assign(text); }             // NOLINT: so is a literal

  constexpr std::string_view view() const noexcept {
    std::size_t size = 0;
    while (size + 1 < N && bytes_[size] != '\0') ++size;
    return {bytes_, size};
  }
  constexpr const char* c_str() const noexcept { return bytes_; }
  constexpr bool empty() const noexcept { return bytes_[0] == '\0'; }
  static constexpr std::size_t capacity() noexcept { return N - 1; }

  friend constexpr bool operator==(const Text& a, const Text& b) noexcept { return a.view() == b.view(); }
  friend constexpr bool operator==(const Text& a, std::string_view b) noexcept { return a.view() == b; }
  friend constexpr bool operator==(const Text& a, const char* b) noexcept { return a.view() == b; }

 private:
  constexpr void assign(std::string_view text) noexcept {
    for (std::size_t i = 0; i < N; ++i) bytes_[i] = i < text.size() && i + 1 < N ? text[i] : '\0';
  }

  static_assert(N >= 2, "Text<N> takes N bytes, the closing zero counted: N is at least 2");
  char bytes_[N] = {};
};

}  // namespace chimera
