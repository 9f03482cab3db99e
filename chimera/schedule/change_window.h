// SPDX-License-Identifier: Apache-2.0
// How much work tasks can ask for in a window of time that contains the change of a transition: leaving tasks release
// before the change only, arriving ones from it on, staying ones all the time. demand.h, with the place of the change
// as one variable more.
//
// Releases lie on grids, and tasks of one period and offset share theirs: its first release from the change on comes
// exactly a period after its last one before. Of all places that a grid can have in the window two ask for most, in
// every interval that begins with it: a release at the beginning of the window, or one at the change. (Between them the
// same releases only come later.) Different grids are taken to lie as they like.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/demand.h"

namespace chimera {

/// What a transition does to a task.
enum class TransitionPart : std::uint8_t { kAbsent, kStays, kLeaves, kArrives };

/// One task of a transition; memory of the analysis.
struct MovingWork {
  RankedWork ranked;
  TransitionPart part = TransitionPart::kStays;
  std::uint32_t partner = 0;  ///< the task that takes its place like for like, itself otherwise
  bool is_chosen = false;     ///< takes part in the sums below
  bool is_judged = false;

  std::uint32_t first_task() const noexcept { return ranked.task < partner ? ranked.task : partner; }
  std::uint32_t last_task() const noexcept { return ranked.task < partner ? partner : ranked.task; }
  bool is_on_grid_of(const MovingWork& other) const noexcept {
    const Work &a = ranked.work, &b = other.ranked.work;
    return a.period == b.period && a.offset == b.offset && !a.server && !b.server;
  }
};

/// Where a grid lies.
enum class GridPlace : std::uint8_t { kAtBegin, kAtChange };

/// A window [0, ...) with the change at `change`; change 0: all of it lies behind the change.
class ChangeWindow {
 public:
  /// `works`, those of one grid in a row, outlive this.
  explicit ChangeWindow(std::span<const MovingWork> works) noexcept : works_(works) {}

  void set_change(Nanoseconds change) noexcept { change_ = change; }
  Nanoseconds change() const noexcept { return change_; }
  /// The next place of the change that can ask for more than all before it; kNever: there is none.
  Nanoseconds next_change() const noexcept;
  /// From now on the grid of `work` lies there and nowhere else; nullptr: as it likes.
  void hold(const MovingWork* work, GridPlace place) noexcept {
    held_ = work;
    place_ = place;
  }

  /// First release of `work` with its grid at `place`. Context: any; pure.
  Nanoseconds first_release(const MovingWork& work, GridPlace place) const noexcept;
  /// Of chosen works: what is released in [0, until], the instant included. O(works).
  Nanoseconds released(Nanoseconds until) const noexcept;
  /// Of chosen works: what is released and due in [0, until]. O(works).
  Nanoseconds due(Nanoseconds until) const noexcept;
  /// The last instant before `before` at which due() may rise; 0: there is none. O(works).
  Nanoseconds due_before(Nanoseconds before) const noexcept;

 private:
  std::int64_t jobs(const MovingWork& work, GridPlace place, Nanoseconds until) const noexcept;
  bool may_lie(const MovingWork& work, GridPlace place) const noexcept;
  template <class Delay>
  Nanoseconds sum(Nanoseconds until, Delay delay) const noexcept;

  std::span<const MovingWork> works_;
  Nanoseconds change_;
  const MovingWork* held_ = nullptr;
  GridPlace place_ = GridPlace::kAtBegin;
};

}  // namespace chimera
