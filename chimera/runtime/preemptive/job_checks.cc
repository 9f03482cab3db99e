// SPDX-License-Identifier: Apache-2.0
// One alarm for the checks of all jobs: set as seldom as the checks allow.
#include "chimera/runtime/preemptive/job_checks.h"

#include <algorithm>

namespace chimera {
namespace {

// The supervisor runs at the ceiling: coming again at once it would keep the job from using up the rest. The gap is
// longer for a job that computed nothing since the last look, and for the capacity of a server.
constexpr Nanoseconds kMinBudgetGap = microseconds(5), kMinIdleGap = microseconds(25);
constexpr Nanoseconds kMinCapacityGap = microseconds(25);

}  // namespace

JobChecks::JobChecks(std::size_t n_tasks, Nanoseconds shortest_deadline)
    : shortest_deadline_(shortest_deadline), due_(n_tasks, kNever), used_(n_tasks) {}

bool JobChecks::acts_at_end_of_budget(const TaskSpec& spec) noexcept {
  const OnMiss reaction = spec.on_overrun;
  const bool acts = reaction == OnMiss::kDemote || reaction == OnMiss::kAbort || reaction == OnMiss::kStop ||
                    reaction == OnMiss::kFlag;
  return acts && spec.budget > Nanoseconds{};
}

bool JobChecks::is_exact(const JobThread& job) noexcept {
  return acts_at_end_of_budget(job.spec) || job.spec.on_miss == OnMiss::kDemote || job.sporadic.has_value();
}

void JobChecks::watch(const JobThread& job, Nanoseconds instant, std::size_t n_ready) noexcept {
  set(job, instant);
  if (has_coalesced_ && n_ready > 1) {  // the check of the job that was alone counts from here on
    for (const Nanoseconds due : due_) instant = std::min(instant, due);
    has_coalesced_ = false;
  }
  const bool is_coalesced = n_ready <= 1 && !is_exact(job);
  has_coalesced_ = has_coalesced_ || is_coalesced;
  arm_by(is_coalesced ? instant + kCoalesceWindow : instant);
}

void JobChecks::arm_by(Nanoseconds instant) noexcept {
  if (instant >= armed_) return;
  armed_ = instant;
  alarm_.set(instant);
}

void JobChecks::rearm(Nanoseconds instant) noexcept {
  has_coalesced_ = false;
  armed_ = instant;
  alarm_.set(instant);
}

void JobChecks::put_off(Nanoseconds now) noexcept {
  if (armed_ > now + shortest_deadline_ + kPutOffMargin) return;
  Nanoseconds next = now + shortest_deadline_ + kCoalesceWindow;
  for (const Nanoseconds due : due_) next = std::min(next, due);
  if (next <= armed_) return;
  armed_ = next;
  alarm_.set(next);
}

Nanoseconds JobChecks::end_of_budget(const JobThread& job, bool is_reported, Nanoseconds now) noexcept {
  if (is_reported || !acts_at_end_of_budget(job.spec)) return kNever;
  const Nanoseconds used = job.used(), last = used_[job.id.index];
  used_[job.id.index] = used;
  return now + std::max(job.spec.budget - used, used == last ? kMinIdleGap : kMinBudgetGap);
}

Nanoseconds JobChecks::end_of_capacity(JobThread& job, Nanoseconds now) noexcept {
  if (!job.sporadic || job.is_demoted) return kNever;
  job.sporadic->charge(job.thread(), false);
  return now + std::max(job.sporadic->job().allowance(now), kMinCapacityGap);
}

}  // namespace chimera
