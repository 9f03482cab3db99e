// SPDX-License-Identifier: Apache-2.0
// Tasks that may not be silent for long: counts the periods in which one that is ON publishes nothing.
#pragma once

#include <cstdint>

#include "chimera/base/ids.h"
#include "chimera/base/time.h"

namespace chimera {

/// `safe_after` of one task. A look that comes more than half a period late counts for nothing: whoever looks was held
/// up, so the task may have been. Context: any; wait-free.
class Silence {
 public:
  Silence(TaskId task, Nanoseconds period, std::uint32_t most) noexcept : task_(task), period_(period), most_(most) {}

  TaskId task() const noexcept { return task_; }
  Nanoseconds due() const noexcept { return due_; }
  /// What its unit shows at `now`: whether the task is ON, and how often it has published. True when it has been silent
  /// for too long; then the count begins anew.
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
  TaskId task_;
  Nanoseconds period_, due_{};
  std::uint64_t published_ = 0;
  std::uint32_t most_, silent_ = 0;
  bool was_on_ = false;
};

}  // namespace chimera
