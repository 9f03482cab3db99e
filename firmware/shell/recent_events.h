// SPDX-License-Identifier: Apache-2.0
// The last events of a context: states, faults, missed deadlines, switches.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "chimera/base/fixed.h"
#include "chimera/base/ids.h"
#include "chimera/base/time.h"
#include "chimera/runtime/plan/switch_receipt.h"
#include "chimera/task/state_machine.h"

namespace chimera::firmware {

enum class ShellEventKind : std::uint8_t { kState, kFault, kMissed, kSwitch };

/// One event. `count` equal ones that were not shown yet are one event, at the instant of the last.
struct ShellEvent {
  static constexpr std::size_t kText = 47;

  Nanoseconds at;
  ShellEventKind kind = ShellEventKind::kState;
  State before = State::kNotCreated, after = State::kNotCreated;  ///< kState
  Method method = Method::kCycle;                                 ///< kFault
  SwitchEnd end = SwitchEnd::kDone;                               ///< kSwitch
  NoSwitch why = NoSwitch::kNone;                                 ///< kSwitch
  TaskId task;                 ///< of kSwitch: that of `why`
  TaskId other;                ///< kMissed: the task that used the time; invalid: unknown
  std::int32_t code = 0;       ///< kFault
  std::uint32_t from = 0, to = 0;  ///< kSwitch: numbers of configurations; UINT32_MAX: none
  std::uint32_t lost = 0;      ///< kSwitch: cycles
  std::uint32_t count = 1;
  FixedString<kText> text;     ///< kFault: its beginning

  /// Both are about the same thing, so that one line can show both.
  bool is_like(const ShellEvent& other_one) const noexcept {
    const bool can_join = kind == ShellEventKind::kFault || kind == ShellEventKind::kMissed;
    return can_join && kind == other_one.kind && task == other_one.task && method == other_one.method &&
           code == other_one.code;
  }
};

/// Context of everything: cycle boundary, or between jobs; wait-free.
class RecentEvents {
 public:
  static constexpr std::uint32_t kKept = 16;

  /// Adds the event, or its count to one like it that was not shown yet. Without room the oldest one goes.
  void note(const ShellEvent& event) noexcept {
    for (std::uint32_t n = shown_; n != made_; ++n) {
      ShellEvent& each = events_[n % kKept];
      if (!each.is_like(event)) continue;
      const std::uint32_t count = each.count + event.count;
      const TaskId other = event.other.is_valid() ? event.other : each.other;
      each = event;
      each.count = count;
      each.other = other;
      return;
    }
    if (made_ - shown_ == kKept) ++shown_, ++lost_;
    events_[made_++ % kKept] = event;
  }
  /// The oldest event that was not shown yet, which is shown now; null: there is none. Its memory is good until note().
  const ShellEvent* take() noexcept {
    return shown_ == made_ ? nullptr : &events_[shown_++ % kKept];
  }
  /// Events that went before they were shown, since the last call.
  std::uint32_t take_lost() noexcept { return std::exchange(lost_, 0); }

 private:
  std::array<ShellEvent, kKept> events_{};
  std::uint32_t made_ = 0, shown_ = 0;  // numbers of the next one to make and to show
  std::uint32_t lost_ = 0;
};

}  // namespace chimera::firmware
