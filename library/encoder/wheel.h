// SPDX-License-Identifier: Apache-2.0
// What an encoder has turned, and how fast: from the two tracks A and B of a wheel, or from a count that wraps.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"

namespace chimera::library {

/// The steps of a Gray code, A before B, or of a count. Context: cycle; wait-free.
class CountedWheel {
 public:
  /// From now on it is at `total`, and what is seen next is no step.
  void begin(std::int64_t total) noexcept {
    total_ = total, velocity_ = 0;
    has_last_ = has_edge_ = false;
  }
  /// Both tracks. False when both have changed, so that nobody knows which way: no step is counted.
  bool see(bool a, bool b, Nanoseconds now, Nanoseconds window, Nanoseconds standstill) noexcept {
    const std::uint64_t phase = a ? (b ? 2 : 1) : (b ? 3 : 0);
    const std::uint64_t moved = has_last_ ? (phase - last_) & 3 : 0;
    step(moved == 1 ? 1 : moved == 3 ? -1 : 0, now, window, standstill);
    last_ = phase, has_last_ = true;
    return moved != 2;
  }
  /// A count that begins anew at `wrap`; 0: at 2^64.
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
  /// An instant at which the wheel stood exactly between two counts.
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
  // From edge to edge, so that a slow wheel is measured over the time it really took. A wheel that turns back passes
  // the same edge again and has gone no way between, so that one that trembles about an edge stands.
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
  // Without an edge it has gone less than a count since the last.
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
  Edge base_;  // where the velocity is measured from
  Nanoseconds last_edge_;
  bool has_last_ = false, has_edge_ = false;
};

}  // namespace chimera::library
