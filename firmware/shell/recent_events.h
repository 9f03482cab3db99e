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
};

/// Context of everything: cycle boundary, or between jobs; wait-free.
class RecentEvents {
 public:
  static constexpr std::uint32_t kKept = 16;

  /// An event of now, for the caller to complete: a fault or missed deadlines that were noted before and not shown yet,
  /// counted `count` more times, or else a new one. Without room the oldest one goes.
  ShellEvent& note(Nanoseconds at, ShellEventKind kind, TaskId task, std::uint32_t count = 1,
                   Method method = Method::kCycle, std::int32_t code = 0) noexcept {
    const bool can_join = kind == ShellEventKind::kFault || kind == ShellEventKind::kMissed;
    for (std::uint32_t n = shown_; can_join && n != made_; ++n) {
      ShellEvent& each = events_[n % kKept];
      if (each.kind != kind || each.task != task || each.method != method || each.code != code) continue;
      each.at = at;
      each.count += count;
      return each;
    }
    if (made_ - shown_ == kKept) ++shown_, ++lost_;
    ShellEvent& made = events_[made_++ % kKept];
    made = {};
    made.at = at;
    made.kind = kind;
    made.method = method;
    made.task = task;
    made.code = code;
    made.count = count;
    return made;
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
