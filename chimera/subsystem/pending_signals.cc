// SPDX-License-Identifier: Apache-2.0
// Keeps the signals whose reports have not come, and the times at which they are given up.
#include "chimera/subsystem/pending_signals.h"

#include <algorithm>

#include "chimera/subsystem/subsystem.h"

namespace chimera::subsystem {

std::uint64_t PendingSignals::post(Signal signal, std::span<const TaskId> tasks, Nanoseconds now) {
  ++last_;
  for (TaskId task : tasks) of(task).push_back({last_, signal, now, now + kAnswerLimit});
  return last_;
}

bool PendingSignals::settle(TaskId task, std::uint64_t command) {
  auto& list = of(task);
  const auto mine = [command](const PendingSignal& entry) { return entry.command == command; };
  const auto found = std::find_if(list.begin(), list.end(), mine);
  if (found == list.end()) return false;
  const bool was_awaited = found->due != kNever;
  const auto is_given_up = [](const PendingSignal& entry) { return entry.due == kNever; };
  list.erase(std::remove_if(list.begin(), found, is_given_up), found);
  std::erase_if(list, mine);
  return was_awaited;
}

bool PendingSignals::is_awaited(TaskId task) const noexcept {
  const auto& list = tasks_[task.index];
  return std::any_of(list.begin(), list.end(), [](const PendingSignal& entry) { return entry.due != kNever; });
}

bool PendingSignals::is_awaited(TaskId task, Signal signal) const noexcept {
  const auto& list = tasks_[task.index];
  return std::any_of(list.begin(), list.end(),
                     [signal](const PendingSignal& entry) { return entry.signal == signal && entry.due != kNever; });
}

bool PendingSignals::is_possible(TaskId task, Signal signal) const noexcept {
  const auto& list = tasks_[task.index];
  return std::any_of(list.begin(), list.end(), [signal](const PendingSignal& entry) { return entry.signal == signal; });
}

Nanoseconds PendingSignals::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (const auto& list : tasks_)
    for (const PendingSignal& entry : list) next = std::min(next, entry.due);
  return next;
}

}  // namespace chimera::subsystem
