// SPDX-License-Identifier: Apache-2.0
// The order of importance among the tasks of a processor, and the time that each part of them may use.
#include "chimera/runtime/preemptive/processor_share.h"

#include <algorithm>

#include "chimera/schedule/utilisation.h"

namespace chimera {
namespace {

constexpr Nanoseconds kReportGap = seconds(1);

}  // namespace

ProcessorShare::ProcessorShare(std::span<const Task> tasks, const std::vector<bool>& is_mine, Policy policy,
                               const Limit& limit)
    : limit_(limit), is_less_important_(tasks.size()), use_(limit.window), use_by_less_(limit.window) {
  std::uint32_t highest = 0;
  Nanoseconds shortest = kNever, longest;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!is_mine[i]) continue;
    const TaskSpec& spec = *tasks[i].spec;
    highest = std::max(highest, spec.criticality);
    shortest = std::min(shortest, spec.period);
    longest = std::max(longest, spec.period);
  }
  double load = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!is_mine[i]) continue;
    const TaskSpec& spec = *tasks[i].spec;
    const bool is_slowest = spec.period == longest && longest > shortest;
    if (has_criticalities(policy)) is_less_important_[i] = spec.criticality < highest;
    if (policy == Policy::kRm) is_less_important_[i] = is_slowest;
    if (!is_less_important_[i]) load += load_of(spec);
  }
  kept_for_important_ = {static_cast<std::int64_t>(load * static_cast<double>(limit.window.count))};
}

void ProcessorShare::set_running(TaskId task, Nanoseconds now) noexcept {
  if (!is_limited()) return;
  use_.set(task.is_valid(), now);
  use_by_less_.set(task.is_valid() && is_less_important_[task.index], now);
}

Nanoseconds ProcessorShare::left(Nanoseconds now) noexcept {
  const Nanoseconds by_less = use_by_less_.used(now), by_others = use_.used(now) - by_less;
  return limit_.share - std::max(kept_for_important_, by_others) - by_less;
}

bool ProcessorShare::may_demote(TaskId task, bool is_over_budget, bool is_most_urgent, Nanoseconds now) noexcept {
  if (is_less_important_[task.index]) return true;
  return used(now) >= limit_.share && (is_over_budget || !is_most_urgent);
}

bool ProcessorShare::note_demoted(TaskId task, Nanoseconds now) noexcept {
  if (now - reported_at_ < kReportGap) return false;
  reported_at_ = now;
  demoted_ = task;
  return true;
}

TaskId ProcessorShare::pop_demoted() noexcept {
  const TaskId task = demoted_;
  demoted_ = TaskId();
  return task;
}

}  // namespace chimera
