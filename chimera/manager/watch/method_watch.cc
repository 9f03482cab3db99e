// SPDX-License-Identifier: Apache-2.0
// Judges from samples of an rtpu's words if a method takes longer than its limit.
#include "chimera/manager/watch/method_watch.h"

#include <utility>

namespace chimera::manager {

MethodVerdict MethodWatch::look(std::uint32_t word, std::uint64_t progress, Nanoseconds at) noexcept {
  const bool is_same = word == word_ && progress == progress_;
  const bool was_away = at - last_ > kWatchGap;
  const Nanoseconds before = last_ - since_;
  last_ = at;
  if (!is_same || word == 0) {
    const bool was_told = std::exchange(is_told_, false);
    const std::uint32_t ended = std::exchange(word_, word);
    progress_ = progress;
    since_ = at;
    return {0, before + head_start_, was_told, was_told ? ended : 0};
  }
  if (was_away) since_ = at - (is_told_ ? before : Nanoseconds{});
  const Nanoseconds since = at - since_;
  if (since < told_) return {};
  const bool is_news = !is_told_ || is_told_again(before + head_start_, since + head_start_);
  is_told_ = true;
  return {word, since + head_start_, is_news};
}

}  // namespace chimera::manager
