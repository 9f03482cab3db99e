// SPDX-License-Identifier: Apache-2.0
// Finds the cause of a missed deadline from the execution times of jobs.
#include "chimera/runtime/job/miss_cause.h"

namespace chimera {

Nanoseconds MissCause::Recent::most_since(Nanoseconds since) const noexcept {
  std::int64_t most = 0;
  for (std::uint32_t i = 0; i < kJobs; ++i)
    if (end_[i].load(std::memory_order_relaxed) >= since.count)
      most = std::max(most, used_[i].load(std::memory_order_relaxed));
  return {most};
}

Nanoseconds MissCause::Recent::sum_since(Nanoseconds since) const noexcept {
  std::int64_t sum = 0;
  std::uint32_t n = 0;
  for (std::uint32_t i = 0; i < kJobs; ++i) {
    if (end_[i].load(std::memory_order_relaxed) < since.count) continue;
    sum += used_[i].load(std::memory_order_relaxed);
    ++n;
  }
  return n == kJobs ? kNever : Nanoseconds{sum};
}

MissCause::MissCause(std::span<const Task> tasks, JobThreads& threads, SetupMemory& memory)
    : tasks_(tasks), threads_(threads), recent_(memory.take<Recent>(tasks.size())),
      judged_(memory.take<Nanoseconds>(tasks.size())), waits_(memory.take<Waits>(tasks.size())) {
  for (Nanoseconds& judged : judged_) judged = Nanoseconds{INT64_MIN / 2};
}

// For how long, at least, no task of this context had the processor although one wanted it; 0: not known.
Nanoseconds MissCause::taken_away(Nanoseconds since, Nanoseconds now) const noexcept {
  Nanoseconds left = now - since;
  for (const Task& task : tasks_) {
    const Nanoseconds used = recent_[task.id.index].sum_since(since);
    if (used == kNever) return {};
    left = left - used - threads_.used_by_job(task.id);
  }
  return std::max(left, Nanoseconds{});
}

// Cases 3 and 4: a job that is under way and needs no other task to be late.
std::optional<MissCause::Verdict> MissCause::by_itself(TaskId missed, Nanoseconds since,
                                                       Nanoseconds now) const noexcept {
  const Nanoseconds used = threads_.used_by_job(missed);
  if (threads_.is_blocked(missed)) return Verdict{missed, used, true};  // 3
  const bool has_budget = tasks_[missed.index].spec->budget > Nanoseconds{};
  if (!has_budget && used * 2 > now - since) return Verdict{missed, used};  // 4
  return std::nullopt;
}

std::optional<MissCause::Verdict> MissCause::judge(TaskId missed, Nanoseconds now) noexcept {
  constexpr Nanoseconds kAway = milliseconds(1);
  const Nanoseconds waited_since{waits_[missed.index].since.exchange(kNever.count, std::memory_order_relaxed)};
  if (!may_judge(missed, now)) return std::nullopt;  // 1
  judged_[missed.index] = now;
  const TaskSpec& spec = *tasks_[missed.index].spec;
  const Nanoseconds since = now - spec.deadline - spec.period;
  Verdict worst{missed, {}};
  Nanoseconds worst_excess{INT64_MIN};
  for (const Task& task : tasks_) {
    const Nanoseconds used = std::max(recent_[task.id.index].most_since(since), threads_.used_by_job(task.id));
    const Nanoseconds allowed = task.spec->budget > Nanoseconds{} ? task.spec->budget : task.spec->period;
    if (used == Nanoseconds{} || used - allowed <= worst_excess) continue;
    worst_excess = used - allowed;
    worst = {task.id, used};
  }
  const Nanoseconds half_waited{(now - waited_since).count / 2};
  if (waited_since == kNever || worst_excess > half_waited) return worst;        // 2
  if (const auto verdict = by_itself(missed, waited_since, now)) return verdict;  // 3, 4
  if (worst_excess > Nanoseconds{}) return worst;                                 // 5
  const Nanoseconds away = taken_away(waited_since, now);
  return away >= kAway ? Verdict{TaskId(), away} : worst;  // 6, 7
}

}  // namespace chimera
