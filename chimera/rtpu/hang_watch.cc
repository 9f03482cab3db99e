// SPDX-License-Identifier: Apache-2.0
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

bool HangWatch::end_hangs(std::uint32_t progress, Nanoseconds now) noexcept {
  if (progress != progress_) {
    progress_ = progress;
    progress_at_ = now;
  }
  return now - progress_at_ > limit_ * 2 + milliseconds(100);
}

}  // namespace chimera
