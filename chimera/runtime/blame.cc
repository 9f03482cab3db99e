// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/blame.h"

namespace chimera {

Nanoseconds Blame::Recent::most_since(Nanoseconds since) const noexcept {
  std::int64_t most = 0;
  for (std::uint32_t i = 0; i < kJobs; ++i)
    if (end_[i].load(std::memory_order_relaxed) >= since.count)
      most = std::max(most, used_[i].load(std::memory_order_relaxed));
  return {most};
}

Nanoseconds Blame::Recent::sum_since(Nanoseconds since) const noexcept {
  std::int64_t sum = 0;
  std::uint32_t n = 0;
  for (std::uint32_t i = 0; i < kJobs; ++i) {
    if (end_[i].load(std::memory_order_relaxed) < since.count) continue;
    sum += used_[i].load(std::memory_order_relaxed);
    ++n;
  }
  return n == kJobs ? kNever : Nanoseconds{sum};
}

Blame::Blame(std::span<const Task> tasks, JobThreads* threads)
    : tasks_(tasks), threads_(threads), recent_(tasks.size()), judged_(tasks.size(), Nanoseconds{INT64_MIN / 2}),
      waits_(tasks.size()) {}

// For how long nobody of this context can have had the processor although somebody wanted it. At least so much; 0: not
// known.
Nanoseconds Blame::taken_away(Nanoseconds since, Nanoseconds now) const noexcept {
  Nanoseconds left = now - since;
  for (const Task& task : tasks_) {
    const Nanoseconds used = recent_[task.id.index].sum_since(since);
    if (used == kNever) return {};
    left = left - used - used_by_job(task.id);
  }
  return std::max(left, Nanoseconds{});
}

// Its job is under way and needs nobody else to be late.
std::optional<Blame::Verdict> Blame::by_itself(TaskId missed, Nanoseconds since, Nanoseconds now) const noexcept {
  const Nanoseconds used = used_by_job(missed);
  if (threads_ != nullptr && threads_->is_blocked(missed)) return Verdict{missed, used, true};
  const bool has_budget = tasks_[missed.index].spec->budget > Nanoseconds{};
  if (!has_budget && used * 2 > now - since) return Verdict{missed, used};
  return std::nullopt;
}

std::optional<Blame::Verdict> Blame::judge(TaskId missed, Nanoseconds now) noexcept {
  constexpr Nanoseconds kSeldom = milliseconds(100), kAway = milliseconds(1);
  const Nanoseconds waited_since{waits_[missed.index].since.exchange(kNever.count, std::memory_order_relaxed)};
  if (now - judged_[missed.index] < kSeldom) return std::nullopt;
  judged_[missed.index] = now;
  const TaskSpec& spec = *tasks_[missed.index].spec;
  const Nanoseconds since = now - spec.deadline - spec.period;
  Verdict worst{missed, {}};
  Nanoseconds worst_excess{INT64_MIN};
  for (const Task& task : tasks_) {
    const Nanoseconds used = std::max(recent_[task.id.index].most_since(since), used_by_job(task.id));
    const Nanoseconds allowed = task.spec->budget > Nanoseconds{} ? task.spec->budget : task.spec->period;
    if (used == Nanoseconds{} || used - allowed <= worst_excess) continue;
    worst_excess = used - allowed;
    worst = {task.id, used};
  }
  if (waited_since == kNever || worst_excess > Nanoseconds{(now - waited_since).count / 2}) return worst;
  if (const auto verdict = by_itself(missed, waited_since, now)) return verdict;
  if (worst_excess > Nanoseconds{}) return worst;
  const Nanoseconds away = taken_away(waited_since, now);
  return away >= kAway ? Verdict{TaskId(), away} : worst;
}

}  // namespace chimera
