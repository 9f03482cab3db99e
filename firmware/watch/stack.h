// SPDX-License-Identifier: Apache-2.0
// How deep a stack was: its words are painted before it is used, and the paint that is left is counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace chimera::firmware {

inline constexpr std::uint32_t kStackPaint = 0x5AC3E7A5;
/// Words at the lower end of a stack that must stay painted: 32 bytes, as the smallest region of an MPU.
inline constexpr std::size_t kGuardWords = 8;

/// A stack that grows from the end of its words to their beginning. Plain value.
struct Stack {
  std::string_view name;
  std::span<const std::uint32_t> words;

  /// Context: any; wait-free.
  bool is_guard_whole() const noexcept {
    const std::size_t n = words.size() < kGuardWords ? words.size() : kGuardWords;
    for (std::size_t i = 0; i < n; ++i)
      if (words[i] != kStackPaint) return false;
    return true;
  }
};

/// Paints the words, of which none is in use. Context: setup.
inline void paint(std::span<std::uint32_t> words) noexcept {
  for (std::uint32_t& word : words) word = kStackPaint;
}

/// Counts the words of a stack that were never used, a piece at a time. Context: any; wait-free.
class StackScan {
 public:
  explicit StackScan(const Stack& stack) noexcept : words_(stack.words) {}

  /// Looks at `most` words more. True: the scan is complete.
  bool go_on(std::size_t most) noexcept {
    for (; most > 0 && unused_ < words_.size(); --most, ++unused_)
      if (words_[unused_] != kStackPaint) return true;
    return unused_ == words_.size();
  }
  /// The greatest depth so far, in bytes. Requires: the scan is complete.
  std::size_t used_bytes() const noexcept { return (words_.size() - unused_) * sizeof(std::uint32_t); }

 private:
  std::span<const std::uint32_t> words_;
  std::size_t unused_ = 0;
};

}  // namespace chimera::firmware
