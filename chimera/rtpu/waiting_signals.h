// SPDX-License-Identifier: Apache-2.0
// Signals of other processes that wait until their task can accept them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "chimera/base/fixed.h"
#include "chimera/runtime/outbox.h"

namespace chimera {

/// A *step* is a signal, or all signals of one transaction. A task keeps the order of its signals. Context of all
/// functions but the constructor: cycle boundary; no allocation.
class WaitingSignals {
 public:
  /// Further posts stay in the rings of their senders.
  static constexpr std::size_t kMost = 512;

  explicit WaitingSignals(std::size_t n_tasks) : is_blocked_(n_tasks) {}
  bool is_full() const noexcept { return posts_.is_full(); }
  /// Requires: not full.
  void add(const Post& post) noexcept { (void)posts_.try_push(post); }

  /// Removes each whole step whose tasks may all be touched and have no earlier signal waiting, in order of arrival.
  /// Calls `may_touch(TaskId)` and `act(std::span<const Post>)`.
  template <class MayTouch, class Act>
  void act(MayTouch&& may_touch, Act&& act) noexcept {
    std::fill(is_blocked_.begin(), is_blocked_.end(), false);
    std::size_t kept = 0, at = 0;
    while (at < posts_.size()) {
      const std::size_t n = step_length(at);
      const std::span<const Post> step(posts_.begin() + at, n == 0 ? posts_.size() - at : n);
      at += step.size();
      if (n != 0 && may_act(step, may_touch)) {
        act(step);
        continue;
      }
      for (const Post& post : step) posts_[kept++] = post;
    }
    while (posts_.size() > kept) posts_.pop_back();
  }

 private:
  // Number of signals of the step; 0: the rest of the step has not arrived yet.
  std::size_t step_length(std::size_t first) const noexcept {
    for (std::size_t i = first; i < posts_.size(); ++i)
      if (!posts_[i].more) return i - first + 1;
    return posts_.is_full() ? posts_.size() - first : 0;
  }
  template <class MayTouch>
  bool may_act(std::span<const Post> step, MayTouch& may_touch) noexcept {
    bool may = true;
    for (const Post& post : step) may = may && !is_blocked_[post.task.index] && may_touch(post.task);
    if (!may)
      for (const Post& post : step) is_blocked_[post.task.index] = true;
    return may;
  }

  FixedVector<Post, kMost> posts_;
  std::vector<bool> is_blocked_;  // by task: an earlier signal for it waits
};

}  // namespace chimera
