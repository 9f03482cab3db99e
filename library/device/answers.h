// SPDX-License-Identifier: Apache-2.0
// The answers of a device: their age, and whether the device may get commands.
#pragma once

#include "chimera/base/time.h"
#include "chimera/task/component.h"

namespace chimera::library {

/// Until the first answer after `on` a device gets only its idle command. A device that does not answer is therefore
/// never commanded, however often its task is restarted. Context: cycle; wait-free.
class Answers {
 public:
  /// For `on`.
  void begin(Nanoseconds now) noexcept {
    heard_ = now;
    has_one_ = false;
  }
  /// A good answer came.
  void take(Nanoseconds now) noexcept {
    heard_ = now;
    has_one_ = true;
  }
  /// No answer could be read so far: the silence begins now.
  void wait(Nanoseconds now) noexcept { heard_ = now; }
  /// Seconds since the last answer, or since `on`.
  double age(Nanoseconds now) const noexcept { return to_seconds(now - heard_); }
  /// True if this cycle sends the idle command.
  bool must_idle(Cycle c) const noexcept { return !has_one_ || c.illegal(); }

 private:
  Nanoseconds heard_;
  bool has_one_ = false;
};

}  // namespace chimera::library
