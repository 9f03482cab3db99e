// SPDX-License-Identifier: Apache-2.0
// Counts the jobs of a window that contains the change of a transition.
#include "chimera/schedule/change_window.h"

#include <algorithm>

namespace chimera {
namespace {

constexpr Nanoseconds kTick{1};

}  // namespace

Nanoseconds ChangeWindow::next_change() const noexcept {
  Nanoseconds next = kNever;
  for (const MovingWork& w : works_) {
    if (w.part != TransitionPart::kLeaves) continue;
    const Nanoseconds period = w.ranked.work.period;
    const std::int64_t n = change_ > Nanoseconds{} ? (change_ - kTick) / period + 1 : 0;
    next = std::min(next, period * n + kTick);
  }
  return next;
}

Nanoseconds ChangeWindow::first_release(const MovingWork& work, GridPlace place) const noexcept {
  const Nanoseconds period = work.ranked.work.period;
  if (work.part == TransitionPart::kArrives)
    return place == GridPlace::kAtChange ? change_ : period * ((change_ + period - kTick) / period);
  return place == GridPlace::kAtChange && !work.ranked.work.server ? change_ - period * (change_ / period)
                                                                   : Nanoseconds{};
}

std::int64_t ChangeWindow::jobs(const MovingWork& work, GridPlace place, Nanoseconds until) const noexcept {
  const Nanoseconds first = first_release(work, place);
  if (work.part == TransitionPart::kLeaves) until = std::min(until, change_ - kTick);
  return until < first ? 0 : (until - first) / work.ranked.work.period + 1;
}

bool ChangeWindow::may_lie(const MovingWork& work, GridPlace place) const noexcept {
  return held_ == nullptr || place == place_ || !work.is_on_grid_of(*held_);
}

// Adds, for each grid, its request at the place where it requests most.
template <class Delay>
Nanoseconds ChangeWindow::sum(Nanoseconds until, Delay delay) const noexcept {
  Nanoseconds all;
  for (std::size_t i = 0; i < works_.size();) {
    const MovingWork& grid = works_[i];
    Nanoseconds most;
    std::size_t end = i;
    for (const GridPlace place : {GridPlace::kAtBegin, GridPlace::kAtChange}) {
      Nanoseconds here;
      for (end = i; end < works_.size() && (end == i || works_[end].is_on_grid_of(grid)); ++end) {
        const MovingWork& w = works_[end];
        if (w.is_chosen) here += w.ranked.work.time * jobs(w, place, until + delay(w));
      }
      if (may_lie(grid, place)) most = std::max(most, here);
    }
    all += most;
    i = end;
  }
  return all;
}

Nanoseconds ChangeWindow::released(Nanoseconds until) const noexcept {
  return sum(until, [](const MovingWork& w) { return w.ranked.jitter; });
}

Nanoseconds ChangeWindow::due(Nanoseconds until) const noexcept {
  return sum(until, [](const MovingWork& w) { return Nanoseconds{} - first_due(w.ranked); });
}

Nanoseconds ChangeWindow::due_before(Nanoseconds before) const noexcept {
  Nanoseconds last;
  for (const MovingWork& w : works_) {
    if (!w.is_chosen) continue;
    for (const GridPlace place : {GridPlace::kAtBegin, GridPlace::kAtChange}) {
      const Nanoseconds first = first_release(w, place) + first_due(w.ranked);
      if (!may_lie(w, place) || before <= first) continue;
      last = std::max(last, w.ranked.work.period * ((before - kTick - first) / w.ranked.work.period) + first);
    }
  }
  return last;
}

}  // namespace chimera
