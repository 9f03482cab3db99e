// SPDX-License-Identifier: Apache-2.0
// Judges from the words of an rtpu's block if a running method comes to its end. It reads no clock and no block:
// samples in, verdicts out.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/platform/life_watch.h"

namespace chimera::manager {

struct MethodVerdict {
  std::uint32_t word = 0;  ///< the method that does not end; 0: none
  Nanoseconds since;       ///< time for which it has run
  /// Report it now: it does not end, it still does not end, or (`ended` is not 0) it has ended.
  bool is_news = false;
  std::uint32_t ended = 0;
};

/// Watches one word: runtime/task_word.h. Context: setup.
class MethodWatch {
 public:
  /// `told`: a method that has run for this long is reported. `head_start`: time that it ran before its word was
  /// published.
  explicit MethodWatch(Nanoseconds told = milliseconds(1500), Nanoseconds head_start = {}) noexcept
      : told_(told), head_start_(head_start) {}

  /// Requires samples in the order of time, a few each second. A gap longer than kWatchGap is not time of the
  /// method; a method not yet reported then starts from zero. `progress` grows when an equal word means another
  /// call of the method.
  MethodVerdict look(std::uint32_t word, std::uint64_t progress, Nanoseconds at) noexcept;

 private:
  const Nanoseconds told_, head_start_;
  std::uint32_t word_ = 0;
  std::uint64_t progress_ = 0;
  Nanoseconds since_, last_;
  bool is_told_ = false;
};

}  // namespace chimera::manager
