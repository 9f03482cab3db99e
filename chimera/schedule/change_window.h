// SPDX-License-Identifier: Apache-2.0
// Bounds the work of tasks in a window of time that contains the change of a transition. Leaving tasks release jobs
// only before the change, arriving tasks only from it on, staying tasks always. Extends demand.h by one variable: the
// place of the change.
//
// Releases lie on grids; tasks of one period and offset share a grid. The first release of a grid from the change on
// comes exactly one period after its last one before. In every interval from the begin of the window, two places of a
// grid request most: a release at the begin, or a release at the change. (Between them the same releases only come
// later.) Different grids are assumed to be independent.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/schedule/demand.h"

namespace chimera {

/// The part of a task in a transition.
enum class TransitionPart : std::uint8_t { kAbsent, kStays, kLeaves, kArrives };

/// A task of a transition; memory of the analysis.
struct MovingWork {
  RankedWork ranked;
  TransitionPart part = TransitionPart::kStays;
  std::uint32_t partner = 0;  ///< the task that replaces it like for like; otherwise its own index
  std::uint64_t partner_tie = 0;
  bool is_chosen = false;     ///< counts in the sums below
  bool is_judged = false;

  std::uint64_t first_tie() const noexcept { return ranked.tie < partner_tie ? ranked.tie : partner_tie; }
  std::uint64_t last_tie() const noexcept { return ranked.tie < partner_tie ? partner_tie : ranked.tie; }
  bool is_on_grid_of(const MovingWork& other) const noexcept {
    const Work &a = ranked.work, &b = other.ranked.work;
    return a.period == b.period && a.offset == b.offset && !a.server && !b.server;
  }
};

/// The place of a grid in the window.
enum class GridPlace : std::uint8_t { kAtBegin, kAtChange };

/// A window [0, ...) with the change at `change`. If `change` is 0, the whole window lies behind the change.
class ChangeWindow {
 public:
  /// `works` must outlive this object; works of one grid are adjacent.
  explicit ChangeWindow(std::span<const MovingWork> works) noexcept : works_(works) {}

  void set_change(Nanoseconds change) noexcept { change_ = change; }
  Nanoseconds change() const noexcept { return change_; }
  /// The next place of the change that can request more than all earlier places; kNever: none.
  Nanoseconds next_change() const noexcept;
  /// Fixes the grid of `work` at `place` from now on; nullptr: each grid is free again.
  void hold(const MovingWork* work, GridPlace place) noexcept {
    held_ = work;
    place_ = place;
  }

  /// First release of `work` if its grid lies at `place`. Context: any; pure.
  Nanoseconds first_release(const MovingWork& work, GridPlace place) const noexcept;
  /// Work of the chosen tasks that is released in [0, until], including the instant `until`. O(works).
  Nanoseconds released(Nanoseconds until) const noexcept;
  /// Work of the chosen tasks that is released and due in [0, until]. O(works).
  Nanoseconds due(Nanoseconds until) const noexcept;
  /// The last instant before `before` at which due() may rise; 0: none. O(works).
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
