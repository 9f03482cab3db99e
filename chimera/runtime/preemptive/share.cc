// SPDX-License-Identifier: Apache-2.0
// The share of the processor: when real-time threads have used too much of it, the kernel takes it from all of them,
// whoever it was. A little before, jobs give way here in order of importance, so that the others keep theirs.
// docs/decisions/0016-share-of-the-processor.md
#include <algorithm>

#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "chimera/schedule/utilisation.h"

namespace chimera {
namespace {

// Jobs that give way are told so seldom.
constexpr Nanoseconds kTellsEvery = seconds(1);
// While others are looked for that should give way, the supervisor comes so often.
constexpr Nanoseconds kLooksEvery = milliseconds(1);

bool is_by_criticality(Policy policy) noexcept { return policy == Policy::kMuf || policy == Policy::kMufLaxity; }

}  // namespace

// By criticality under maximum urgency first, the longest period under rate monotonic; deadlines say nothing of it.
void PreemptiveExecutor::find_less_important() {
  std::uint32_t highest = 0;
  Nanoseconds shortest = kNever, longest;
  for (const JobThread& job : threads_) {
    highest = std::max(highest, spec(job).criticality);
    shortest = std::min(shortest, spec(job).period);
    longest = std::max(longest, spec(job).period);
  }
  double load = 0;
  for (JobThread& job : threads_) {
    const TaskSpec& s = spec(job);
    const bool is_slowest = s.period == longest && longest > shortest;
    if (is_by_criticality(labels_.policy())) job.is_less_important = s.criticality < highest;
    if (labels_.policy() == Policy::kRm) job.is_less_important = is_slowest;
    if (!job.is_less_important) load += load_of(s);
  }
  kept_for_important_ = {static_cast<std::int64_t>(load * static_cast<double>(place_.window.count))};
}

// Less important tasks have what the others do not need: by their budgets, or by what they used where that is more.
// Only where the others alone use too much one of them gives way.
void PreemptiveExecutor::keep_share(Nanoseconds now, const JobThread* own) noexcept {
  if (place_.share == kNever || labels_.size() == 0) return;
  const Nanoseconds used = use_.used(now), by_less = use_by_less_.used(now);
  const Nanoseconds left = place_.share - std::max(kept_for_important_, used - by_less) - by_less;
  if (left <= Nanoseconds{})
    if (JobThread* job = who_gives_way(used >= place_.share, own)) give_way(*job, now);
  const Nanoseconds look = now + std::max(left, kLooksEvery);
  if (look < armed_) arm(look);
}

// `own` has the section and cannot. Of those that kept to their budgets the most urgent one goes on.
JobThread* PreemptiveExecutor::who_gives_way(bool anybody, const JobThread* own) noexcept {
  const auto jobs = labels_.jobs();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    JobThread& job = *of_task_[jobs[i].task.index];
    const bool is_there = job.phase == JobPhase::kWaiting || job.phase == JobPhase::kBegun;
    const bool is_over = releases_.misses().is_reported_overrun(job.task);
    const bool may = job.is_less_important || (anybody && (is_over || i + 1 < jobs.size()));
    if (&job != own && is_there && may) return &job;
  }
  return nullptr;
}

void PreemptiveExecutor::give_way(JobThread& job, Nanoseconds now) noexcept {
  JobPhase phase = JobPhase::kWaiting;
  const bool waits = job.phase.compare_exchange_strong(phase, JobPhase::kChanged);
  if (!waits && phase != JobPhase::kBegun) return;
  demote(job, now);
  if (waits) job.phase = JobPhase::kWaiting;
  if (now - told_ < kTellsEvery) return;
  told_ = now;
  gave_way_ = job.task;
  ring_edge();
}

}  // namespace chimera
