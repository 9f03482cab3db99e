// SPDX-License-Identifier: Apache-2.0
// Whether a method that is under way comes to its end, judged from the words of a unit's block. Knows no clock and asks
// nobody: samples in, verdicts out.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/platform/life_watch.h"

namespace chimera::manager {

struct MethodVerdict {
  std::uint32_t word = 0;  ///< what does not end; 0: nothing
  Nanoseconds since;       ///< for how long
  bool is_news = false;    ///< to be told now: it does not end, it still does not, or (`ended` is not 0) it has ended
  std::uint32_t ended = 0;
};

/// Of one word: runtime/task_word.h. Context: setup.
class MethodWatch {
 public:
  /// `told`: a method under way for this long is reported; `head_start`: the time that it took before its word was
  /// published.
  explicit MethodWatch(Nanoseconds told = milliseconds(1500), Nanoseconds head_start = {}) noexcept
      : told_(told), head_start_(head_start) {}

  /// Samples come in the order of time, a few in each second; after a gap longer than kWatchGap nothing is known.
  /// `progress` grows when an equal word means another call of the method.
  MethodVerdict look(std::uint32_t word, std::uint64_t progress, Nanoseconds at) noexcept;

 private:
  const Nanoseconds told_, head_start_;
  std::uint32_t word_ = 0;
  std::uint64_t progress_ = 0;
  Nanoseconds since_, last_;
  bool is_told_ = false;
};

}  // namespace chimera::manager
