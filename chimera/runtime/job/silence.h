// SPDX-License-Identifier: Apache-2.0
// Tasks that may not be silent for long: counts the periods in which one that is ON publishes nothing.
#pragma once

#include <algorithm>
#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/runtime/application_spec.h"

namespace chimera {

/// `safe_after` of one task, or the `stale_after` of a standby of it. A check that comes more than half a period late
/// counts for nothing: the checking thread was delayed, so the task may have been, too. Context: any; wait-free.
class Silence {
 public:
  Silence(TaskId task, Nanoseconds period, std::uint32_t most) noexcept : task_(task), period_(period), most_(most) {}

  /// For the sake of a standby that takes over when its primary is dead: as many periods, each `period` long, as it
  /// takes until what the primary published is older than `stale_after`. Requires: that is above 0.
  static Silence of(const StandbySpec& standby, Nanoseconds period) noexcept {
    const std::int64_t most = (standby.stale_after.count - 1) / period.count + 1;
    Silence made(standby.primary, period, static_cast<std::uint32_t>(std::min<std::int64_t>(most, UINT32_MAX)));
    made.standby_ = standby.standby;
    return made;
  }

  TaskId task() const noexcept { return task_; }
  /// The standby that takes over; invalid: the count protects devices.
  TaskId standby() const noexcept { return standby_; }
  Nanoseconds due() const noexcept { return due_; }
  /// `is_on` and `published` are the state and the count of publications that its rtpu shows at `now`. True if the task
  /// has been silent for too long; then the count begins anew.
  bool look(bool is_on, std::uint64_t published, Nanoseconds now) noexcept {
    const bool is_late = now - due_ > Nanoseconds{period_.count / 2};
    due_ = is_late ? now + period_ : due_ + period_;
    const bool is_news = !is_on || !was_on_ || published != published_;
    was_on_ = is_on;
    published_ = published;
    if (is_news) silent_ = 0;
    else if (!is_late) ++silent_;
    if (silent_ < most_) return false;
    silent_ = 0;
    was_on_ = false;
    return true;
  }

 private:
  TaskId task_, standby_;
  Nanoseconds period_, due_{};
  std::uint64_t published_ = 0;
  std::uint32_t most_, silent_ = 0;
  bool was_on_ = false;
};

}  // namespace chimera
