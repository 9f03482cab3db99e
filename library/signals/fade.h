// SPDX-License-Identifier: Apache-2.0
// Lets a difference fade smoothly: a source that starts elsewhere than the machine stands comes to its own values
// without a jump.
#pragma once

namespace chimera::library {

/// The share of a difference that is left: 1 at the start, 0 after `duration` seconds. Velocity and acceleration are 0
/// at both ends; the greatest velocity is 1.875 / duration. A duration of 0 fades at once. Context: cycle; wait-free.
class Fade {
 public:
  void start(double duration) noexcept {
    duration_ = duration;
    elapsed_ = 0;
  }
  void advance(double dt) noexcept { elapsed_ += dt; }
  double left() const noexcept {
    if (!(elapsed_ < duration_)) return 0;
    const double u = elapsed_ / duration_;
    return 1 - u * u * u * (10 + u * (6 * u - 15));
  }

 private:
  double duration_ = 0, elapsed_ = 0;  // s
};

}  // namespace chimera::library
