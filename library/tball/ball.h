// SPDX-License-Identifier: Apache-2.0
// The state of a ball with six degrees of freedom, from input events.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "chimera/base/time.h"

namespace chimera::library {

/// One event, with Linux's numbers (linux/input-event-codes.h).
struct BallEvent {
  std::uint16_t type = 0;
  std::uint16_t code = 0;
  std::int32_t value = 0;
};

inline constexpr std::uint16_t kSyncEvent = 0, kKeyEvent = 1, kRelativeEvent = 2, kAbsoluteEvent = 3;
inline constexpr std::uint16_t kReport = 0, kDropped = 3;  // codes of kSyncEvent
inline constexpr std::uint16_t kFirstButton = 0x100;       // BTN_0
inline constexpr std::size_t kBallAxes = 6, kBallButtons = 16;

/// The ball as of the last complete report. A relative axis reports only values other than 0, so a silence of `hold`
/// means 0. An absolute axis reports every change.
class Ball {
 public:
  /// Puts the ball at rest with no button pressed. `full` counts are a full deflection. Context: any; wait-free.
  void reset(std::int32_t full, Nanoseconds hold) noexcept {
    *this = {};
    full_ = full;
    hold_ = hold;
  }
  /// Puts all axes to rest. Context: cycle; wait-free.
  void rest() noexcept { shown_ = next_ = {}; }

  /// Accepts an event at time `at`. The next report makes it effective. Context: cycle; wait-free.
  void take(const BallEvent& event, Nanoseconds at) noexcept {
    if (event.type == kSyncEvent && event.code == kDropped) {
      is_deaf_ = true;  // the kernel lost events, so old deflections may be wrong
      return rest();
    }
    if (event.type == kSyncEvent && event.code == kReport) return report(at);
    if (is_deaf_) return;
    const bool is_axis = event.type == kRelativeEvent || event.type == kAbsoluteEvent;
    if (is_axis && event.code < kBallAxes) next_[event.code] = {event.value, event.type == kRelativeEvent, true, {}};
    if (event.type == kKeyEvent && event.code >= kFirstButton && event.code < kFirstButton + kBallButtons) {
      const auto bit = static_cast<std::int32_t>(1u << (event.code - kFirstButton));
      next_buttons_ = event.value != 0 ? next_buttons_ | bit : next_buttons_ & ~bit;
    }
  }
  /// Deflection of axis x, y, z, about x, about y, about z: -1 to 1. Context: cycle; wait-free.
  double deflection(std::size_t axis, Nanoseconds now) const noexcept {
    const Axis& a = shown_[axis];
    if (a.is_relative && now - a.at > hold_) return 0;
    const double part = static_cast<double>(a.value) / static_cast<double>(full_);
    return part > 1 ? 1 : part < -1 ? -1 : part;
  }
  /// One bit for each pressed button. Context: cycle; wait-free.
  std::int32_t buttons() const noexcept { return buttons_; }

 private:
  struct Axis {
    std::int32_t value = 0;
    bool is_relative = false;
    bool is_new = false;
    Nanoseconds at;
  };

  void report(Nanoseconds at) noexcept {
    if (is_deaf_) {
      is_deaf_ = false;
      return;
    }
    for (std::size_t i = 0; i < kBallAxes; ++i) {
      if (!next_[i].is_new) continue;
      next_[i].is_new = false;
      next_[i].at = at;
      shown_[i] = next_[i];
    }
    buttons_ = next_buttons_;
  }

  std::array<Axis, kBallAxes> shown_{}, next_{};
  std::int32_t buttons_ = 0, next_buttons_ = 0, full_ = 1;
  Nanoseconds hold_;
  bool is_deaf_ = false;
};

}  // namespace chimera::library
