// SPDX-License-Identifier: Apache-2.0
// Lets tasks join and leave the releases as they go ON and OFF.
#include "chimera/runtime/life/members.h"

namespace chimera {

void Members::follow_all(Nanoseconds now) noexcept {
  for (Task& task : tasks_) {
    if (task.is_busy) continue;  // the end of its job follows
    follow(task, now);
    if (task.is_tapped) tap_.append_row(task);
  }
}

void Members::follow(Task& task, Nanoseconds now) noexcept {
  JobRecord& record = records_[task.id.index];
  const bool on = task.state == State::kOn;
  if (on == record.is_on) return;
  record.is_on = on;
  tap_.record(TapKind::kState, now, task.id, static_cast<std::uint64_t>(task.shown_state()));
  task.profile.on_before = task.profile.on_by(now);
  task.profile.on_since = on ? now : kNever;
  if (on) join(task, now);
  else leave(task);
  if (guest_ != nullptr) guest_->show(task);
}

void Members::leave(Task& task) noexcept {
  --n_on_;
  if constexpr (mechanisms::kEvents) events_.leave(task);
  lose_events(task);
  queue_.leave(task.id);
}

void Members::lose_events(Task& task) noexcept {
  task.profile.events_lost += task.events;
  task.events = 0;
}

void Members::join(Task& task, Nanoseconds now) noexcept {
  JobRecord& record = records_[task.id.index];
  ++n_on_;
  record.dropped = 0;
  record.skip_next = false;
  task.profile.missed_in_a_row = 0;
  task.last_release = now - task.spec->period;
  const bool has_events = mechanisms::kEvents && task.spec->has_events;
  if (task.spec->server || (has_events && events_.join(task, now))) return;  // released by events
  lose_events(task);
  queue_.join(task.id, now);
  // dt of the first cycle is the period, whatever part of one passed since on.
  task.last_release = queue_.classes().first_release(task.id.index) - task.spec->period;
}

}  // namespace chimera
