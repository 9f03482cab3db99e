// SPDX-License-Identifier: Apache-2.0
// What input events say about a ball with six degrees of freedom.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "chimera/base/time.h"

namespace chimera::library {

/// One event as Linux numbers them (linux/input-event-codes.h).
struct BallEvent {
  std::uint16_t type = 0;
  std::uint16_t code = 0;
  std::int32_t value = 0;
};

inline constexpr std::uint16_t kSyncEvent = 0, kKeyEvent = 1, kRelativeEvent = 2, kAbsoluteEvent = 3;
inline constexpr std::uint16_t kReport = 0, kDropped = 3;  // codes of kSyncEvent
inline constexpr std::uint16_t kFirstButton = 0x100;       // BTN_0
inline constexpr std::size_t kBallAxes = 6, kBallButtons = 16;

/// The ball as of the last whole report. A relative axis says only what is not zero, so one that is silent for `hold`
/// has come back; an absolute one says every change.
class Ball {
 public:
  /// At rest, nothing pressed; `full` counts are a full deflection. Context: any; wait-free.
  void reset(std::int32_t full, Nanoseconds hold) noexcept {
    *this = {};
    full_ = full;
    hold_ = hold;
  }
  /// Lets go of all axes. Context: cycle; wait-free.
  void rest() noexcept { shown_ = next_ = {}; }

  /// Takes an event seen at `at`; it counts from the report that ends it. Context: cycle; wait-free.
  void take(const BallEvent& event, Nanoseconds at) noexcept {
    if (event.type == kSyncEvent && event.code == kDropped) {
      is_deaf_ = true;  // the kernel lost events: what was held may long be let go
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
  /// Of axis x, y, z, about x, about y, about z: -1 to 1. Context: cycle; wait-free.
  double deflection(std::size_t axis, Nanoseconds now) const noexcept {
    const Axis& a = shown_[axis];
    if (a.is_relative && now - a.at > hold_) return 0;
    const double part = static_cast<double>(a.value) / static_cast<double>(full_);
    return part > 1 ? 1 : part < -1 ? -1 : part;
  }
  /// A bit for each button that is pressed. Context: cycle; wait-free.
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
