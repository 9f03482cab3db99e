// SPDX-License-Identifier: Apache-2.0
// Counts and speed of an encoder wheel, from the two tracks A and B or from a count that wraps.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"

namespace chimera::library {

/// Counts the steps of a Gray code, A before B, or of a count. Context: cycle; wait-free.
class CountedWheel {
 public:
  /// Sets the total. The next input gives no step.
  void begin(std::int64_t total) noexcept {
    total_ = total, velocity_ = 0;
    has_last_ = has_edge_ = false;
  }
  /// Reads both tracks. Returns false, without a step, if both have changed: the direction is then unknown.
  bool see(bool a, bool b, Nanoseconds now, Nanoseconds window, Nanoseconds standstill) noexcept {
    const std::uint64_t phase = a ? (b ? 2 : 1) : (b ? 3 : 0);
    const std::uint64_t moved = has_last_ ? (phase - last_) & 3 : 0;
    step(moved == 1 ? 1 : moved == 3 ? -1 : 0, now, window, standstill);
    last_ = phase, has_last_ = true;
    return moved != 2;
  }
  /// Reads a count that wraps at `wrap`; 0 means 2^64.
  void see(std::int64_t count, std::uint64_t wrap, Nanoseconds now, Nanoseconds window,
           Nanoseconds standstill) noexcept {
    const auto found = static_cast<std::uint64_t>(count);
    step(has_last_ ? shortest(static_cast<std::int64_t>(found - last_), wrap) : 0, now, window, standstill);
    last_ = found, has_last_ = true;
  }
  bool has_last() const noexcept { return has_last_; }
  std::int64_t total() const noexcept { return total_; }
  /// Counts a second.
  double velocity() const noexcept { return velocity_; }

 private:
  /// The instant at which the wheel was exactly between two counts.
  struct Edge {
    std::int64_t place = 0;
    Nanoseconds at;
  };

  static std::int64_t shortest(std::int64_t way, std::uint64_t wrap) noexcept {
    if (wrap == 0) return way;
    const auto turn = static_cast<std::int64_t>(wrap);
    way %= turn;
    return way >= turn - turn / 2 ? way - turn : way < -(turn / 2) ? way + turn : way;
  }
  // Measures from edge to edge, so that the interval of a slow wheel is exact. A wheel that turns back passes the same
  // edge and has not moved: a wheel that trembles at an edge has speed 0.
  void step(std::int64_t way, Nanoseconds now, Nanoseconds window, Nanoseconds standstill) noexcept {
    if (way == 0) return wait(now, standstill);
    total_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(total_) + static_cast<std::uint64_t>(way));
    const Edge edge{way > 0 ? total_ : total_ + 1, now};
    last_edge_ = now;
    if (!has_edge_) base_ = edge, has_edge_ = true;
    if (edge.at == base_.at || edge.at - base_.at < window) return;
    velocity_ = static_cast<double>(edge.place - base_.place) / to_seconds(edge.at - base_.at);
    base_ = edge;
  }
  // Without a new edge the wheel has moved less than one count since the last edge.
  void wait(Nanoseconds now, Nanoseconds standstill) noexcept {
    if (!has_edge_) return;
    const Nanoseconds elapsed = now - last_edge_;
    if (elapsed > standstill) {
      velocity_ = 0;
      has_edge_ = false;
      return;
    }
    const double most = 1 / to_seconds(elapsed);
    if (velocity_ > most) velocity_ = most;
    if (velocity_ < -most) velocity_ = -most;
  }

  std::int64_t total_ = 0;
  std::uint64_t last_ = 0;
  double velocity_ = 0;
  Edge base_;  // start of the velocity measurement
  Nanoseconds last_edge_;
  bool has_last_ = false, has_edge_ = false;
};

}  // namespace chimera::library
