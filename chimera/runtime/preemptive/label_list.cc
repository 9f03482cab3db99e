// SPDX-License-Identifier: Apache-2.0
// Keeps ready jobs in order of urgency and finds a free priority level between two of them.
#include "chimera/runtime/preemptive/label_list.h"

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

constexpr std::int32_t kStep = 4;  // most levels that are left free beside a new first or last job

}  // namespace

LabelList::LabelList(Policy policy, std::size_t capacity, std::int32_t base, std::int32_t ceiling)
    : policy_(policy), base_(base), ceiling_(ceiling) {
  CHIMERA_ASSERT(ceiling - base >= 2);
  jobs_.reserve(capacity + 1);
  changes_.reserve(3 * capacity + 4);  // every job may move twice in one rekey
}

// A full tie keeps the job that runs; among the others their tie decides.
bool LabelList::goes_before(const LabelledJob& a, const LabelledJob& b) const noexcept {
  if (is_more_urgent(policy_, a.urgency, b.urgency)) return true;
  if (is_more_urgent(policy_, b.urgency, a.urgency)) return false;
  if (a.task == running_ || b.task == running_) return a.task == running_;
  return a.tie < b.tie;
}

// The place above all jobs that it goes before. A job that ran once stands above its equals, so equals need not be in
// the order of their ties. The place is then between a job that it goes before and one that it does not.
std::size_t LabelList::place_of(const LabelledJob& job) const noexcept {
  const auto goes_before_it = [&](const LabelledJob& other) { return goes_before(job, other); };
  return static_cast<std::size_t>(std::partition_point(jobs_.begin(), jobs_.end(), goes_before_it) - jobs_.begin());
}

// From the most urgent on: it is mostly one of those that ends.
std::size_t LabelList::find(TaskId task) const noexcept {
  for (std::size_t at = jobs_.size(); at-- > 0;)
    if (jobs_[at].task == task) return at;
  return jobs_.size();
}

void LabelList::set(std::size_t at, std::int32_t level) noexcept {
  if (jobs_[at].level == level) return;
  jobs_[at].level = level;
  changes_.push_back({jobs_[at].task, level});
}

std::span<const LevelChange> LabelList::insert(const LabelledJob& job) noexcept {
  changes_.clear();
  const std::size_t at = place_of(job);
  jobs_.insert(jobs_.begin() + static_cast<std::ptrdiff_t>(at), job);
  jobs_[at].level = ceiling_;  // where its thread is
  label(at);
  // Its own change comes last: with it the thread leaves the ceiling.
  const auto own = std::find_if(changes_.begin(), changes_.end(),
                                [&](const LevelChange& change) { return change.task == job.task; });
  std::rotate(own, own + 1, changes_.end());
  return changes_;
}

// The job stands at its place, without a level yet.
void LabelList::label(std::size_t at) noexcept {
  if (at < n_parked_) {
    ++n_parked_;
    return set(at, base_);
  }
  const std::int32_t low = below(at), high = above(at + 1);
  if (high - low >= 2) {
    const bool is_first = at == n_parked_, is_last = at + 1 == jobs_.size();
    if (is_last && !is_first) return set(at, std::min(low + kStep, high - 1));
    if (is_first && !is_last) return set(at, high - std::clamp((high - low) / 4, 1, kStep));  // others follow below it
    return set(at, low + (high - low) / 2);
  }
  if (make_room(at, kFewMoves)) return;
  if (at - n_parked_ <= kFewMoves) return park_up_to(at + 1);
  park_up_to(n_parked_ + (at - n_parked_) / 2);  // more than one at a time, or the next insertion is here again
  const bool made = make_room(at, jobs_.size());
  CHIMERA_ASSERT(made);
}

// Moves the shorter of the two runs of neighbours that end at a free level, by one level, from the outside in.
bool LabelList::make_room(std::size_t at, std::size_t most_moves) noexcept {
  std::size_t up = at + 1;  // first one above that could move up alone
  while (up < jobs_.size() && above(up + 1) - jobs_[up].level < 2) ++up;
  std::size_t down = at;  // the one before it is the first one below that could move down alone
  while (down > n_parked_ && jobs_[down - 1].level - below(down - 1) < 2) --down;
  const std::size_t none = jobs_.size() + 1;
  const std::size_t moves_up = up < jobs_.size() ? up - at : none;
  const std::size_t moves_down = down > n_parked_ ? at - down + 1 : none;
  if (std::min(moves_up, moves_down) > most_moves || std::min(moves_up, moves_down) == none) return false;
  if (moves_up <= moves_down) {
    for (std::size_t i = up; i > at; --i) set(i, jobs_[i].level + 1);
  } else {
    for (std::size_t i = down - 1; i < at; ++i) set(i, jobs_[i].level - 1);
  }
  set(at, below(at) + 1);
  return true;
}

void LabelList::park_up_to(std::size_t end) noexcept {
  for (std::size_t i = n_parked_; i < end; ++i) set(i, base_);
  n_parked_ = end;
}

void LabelList::take_out(std::size_t at) noexcept {
  jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(at));
  if (at < n_parked_) --n_parked_;
}

std::span<const LevelChange> LabelList::remove(TaskId task) noexcept {
  changes_.clear();
  const std::size_t at = find(task);
  if (at == jobs_.size()) return changes_;
  take_out(at);
  promote();
  return changes_;
}

// When the parked ones are about to run, the most urgent of them get levels of their own, evenly spaced.
void LabelList::promote() noexcept {
  if (n_parked_ == 0 || jobs_.size() - n_parked_ > 1) return;
  const std::int32_t high = above(n_parked_);
  const auto room = static_cast<std::size_t>(std::max(0, high - base_ - 1));
  const std::size_t count = std::min(n_parked_, room);
  const std::int32_t step = count == 0 ? 0 : (high - base_) / static_cast<std::int32_t>(count + 1);
  for (std::size_t i = 0; i < count; ++i) {
    --n_parked_;
    set(n_parked_, high - std::max(step, 1) * static_cast<std::int32_t>(i + 1));
  }
}

std::span<const LevelChange> LabelList::rekey(TaskId task, const Urgency& urgency) noexcept {
  changes_.clear();
  const std::size_t at = find(task);
  if (at == jobs_.size()) return changes_;
  LabelledJob job = jobs_[at];
  job.urgency = urgency;
  const bool stays_above = at == 0 || !goes_before(jobs_[at - 1], job);
  const bool stays_below = at + 1 == jobs_.size() || !goes_before(job, jobs_[at + 1]);
  if (stays_above && stays_below) {
    jobs_[at].urgency = urgency;
    return changes_;
  }
  take_out(at);
  const std::size_t to = place_of(job);
  jobs_.insert(jobs_.begin() + static_cast<std::ptrdiff_t>(to), job);
  label(to);
  promote();
  return changes_;
}

}  // namespace chimera
