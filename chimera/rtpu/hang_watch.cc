// SPDX-License-Identifier: Apache-2.0
// Judges from counters whether the loop or a method of the rtpu hangs.
#include "chimera/rtpu/hang_watch.h"

namespace chimera {

bool HangWatch::loop_hangs(std::uint32_t running, std::uint64_t beats, Nanoseconds now) noexcept {
  if (running == 0 || beats != beats_ || running != running_) {
    beats_ = beats;
    running_ = running;
    beaten_at_ = now;
  }
  return now - beaten_at_ > limit_;
}

bool HangWatch::method_hangs(std::uint32_t method, std::uint32_t progress, Nanoseconds now) noexcept {
  if (method == 0 || method != method_ || progress != method_progress_) {
    method_ = method;
    method_progress_ = progress;
    method_at_ = now;
  }
  return now - method_at_ > limit_;
}

bool HangWatch::end_hangs(std::uint32_t progress, Nanoseconds now) noexcept {
  if (progress != progress_) {
    progress_ = progress;
    progress_at_ = now;
  }
  return now - progress_at_ > limit_ * 2 + milliseconds(100);
}

}  // namespace chimera
