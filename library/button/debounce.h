// SPDX-License-Identifier: Apache-2.0
// Removes the bouncing of a contact.
#pragma once

#include "chimera/base/time.h"

namespace chimera::library {

/// Follows a level after it has stayed the same for a time. Plain value. Context: cycle; wait-free.
class Debounce {
 public:
  enum class Edge : unsigned char { kNone, kRise, kFall };

  /// `time`: for which a new level must last; 0: none.
  void set_time(Nanoseconds time) noexcept { time_ = time; }
  /// The next level is taken as it is, without an edge.
  void forget() noexcept { is_known_ = false; }
  /// The contact has `level` at `now`. A level that changes back within the time is ignored.
  Edge follow(bool level, Nanoseconds now) noexcept {
    if (!is_known_) level_ = level;
    is_known_ = true;
    if (level == level_) {
      is_changing_ = false;
      return Edge::kNone;
    }
    if (!is_changing_) since_ = now;
    is_changing_ = true;
    if (now - since_ < time_) return Edge::kNone;
    level_ = level;
    is_changing_ = false;
    return level ? Edge::kRise : Edge::kFall;
  }
  bool level() const noexcept { return level_; }

 private:
  Nanoseconds time_, since_;
  bool level_ = false, is_known_ = false, is_changing_ = false;
};

}  // namespace chimera::library
