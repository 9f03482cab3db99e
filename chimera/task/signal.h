// SPDX-License-Identifier: Apache-2.0
// The signals that move a task between its states (1994 paper, section 3.3), and the nine methods.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/base/assert.h"
#include "chimera/task/abi.h"

namespace chimera {

/// The signals of a task. `kWakeup` comes from the timer or the event source. Sent by a task, it rings the doorbell of
/// a task that events release.
enum class Signal : std::uint32_t {
  kSpawn = CHIMERA_SIGNAL_SPAWN,
  kOn = CHIMERA_SIGNAL_ON,
  kOff = CHIMERA_SIGNAL_OFF,
  kKill = CHIMERA_SIGNAL_KILL,
  kClear = CHIMERA_SIGNAL_CLEAR,
  kReinit = CHIMERA_SIGNAL_REINIT,
  kWakeup = CHIMERA_SIGNAL_WAKEUP,
};

/// The methods of a component, in the order of the table in chimera_component.
enum class Method : std::uint32_t {
  kInit = CHIMERA_INIT,
  kReinit = CHIMERA_REINIT,
  kOn = CHIMERA_ON,
  kCycle = CHIMERA_CYCLE,
  kSync = CHIMERA_SYNC,
  kOff = CHIMERA_OFF,
  kKill = CHIMERA_KILL,
  kError = CHIMERA_ERROR,
  kClear = CHIMERA_CLEAR,
};

/// "cycle" for kCycle. Context: any; wait-free.
constexpr const char* method_name(Method method) noexcept {
  constexpr const char* kNames[CHIMERA_METHODS] = {"init", "reinit", "on",    "cycle", "sync",
                                                   "off",  "kill",   "error", "clear"};
  return kNames[static_cast<std::uint32_t>(method)];
}

/// "reinit" for kReinit. Context: any; wait-free.
constexpr const char* signal_name(Signal signal) noexcept {
  constexpr const char* kNames[CHIMERA_SIGNALS] = {"spawn", "on", "off", "kill", "clear", "reinit", "wakeup"};
  return kNames[static_cast<std::uint32_t>(signal)];
}

/// At most `most` signals that wait, the oldest first, in a few bytes. Context: any; wait-free.
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
