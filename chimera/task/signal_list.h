// SPDX-License-Identifier: Apache-2.0
// Signals that wait, in a few bytes: every task has such a list.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/base/assert.h"
#include "chimera/task/signal.h"

namespace chimera {

/// At most `most` signals, the oldest first. Context: any; wait-free.
template <std::size_t most>
class SignalList {
 public:
  bool empty() const noexcept { return size_ == 0; }
  /// Adds `signal` as the newest; false, with nothing changed, when full.
  [[nodiscard]] bool try_push(Signal signal) noexcept {
    if (size_ == most) return false;
    signals_[size_++] = static_cast<std::uint8_t>(signal);
    return true;
  }
  /// `signal` takes the place of the newest. Requires: !empty().
  void replace_newest(Signal signal) noexcept {
    CHIMERA_ASSERT(size_ > 0);
    signals_[size_ - 1] = static_cast<std::uint8_t>(signal);
  }
  /// Removes the oldest. Requires: !empty().
  Signal take_oldest() noexcept {
    CHIMERA_ASSERT(size_ > 0);
    const auto oldest = static_cast<Signal>(signals_[0]);
    --size_;
    for (std::size_t i = 0; i < size_; ++i) signals_[i] = signals_[i + 1];
    return oldest;
  }

 private:
  static_assert(most > 0 && most < UINT8_MAX);
  std::uint8_t signals_[most] = {};
  std::uint8_t size_ = 0;
};

}  // namespace chimera
