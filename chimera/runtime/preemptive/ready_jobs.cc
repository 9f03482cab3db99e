// SPDX-License-Identifier: Apache-2.0
// Passes the levels of the ready list to the kernel, and for tests compares them with those in the kernel.
#include "chimera/runtime/preemptive/ready_jobs.h"

#include "chimera/platform/realtime.h"

namespace chimera {
namespace {

constexpr int kUnusedCeiling = 20;  // of labels that are never passed to the kernel

Nanoseconds rounded(Nanoseconds t, Nanoseconds quantum) noexcept {
  return quantum * ((t.count + quantum.count / 2) / quantum.count);
}

}  // namespace

ReadyJobs::ReadyJobs(TaskSet& set, const ProcessorPlace& place, Policy policy)
    : place_(place), has_levels_(place.ceiling > 0 && may_be_realtime(place.ceiling)),
      labels_(policy, set.tasks().size(), place.ceiling > 0 ? place.base : 0,
              place.ceiling > 0 ? place.ceiling : kUnusedCeiling),
      of_task_(set.tasks().size()) {
  for (Task& task : set.tasks())
    if (set.is_mine(task.id)) of_task_[task.id.index] = &threads_.emplace_back(task);
}

int ReadyJobs::insert(JobThread& job, Nanoseconds deadline, Nanoseconds remaining, const JobThread* own) noexcept {
  LabelledJob ready;
  ready.task = job.id;
  ready.urgency = urgency_of(job, deadline, remaining);
  ready.tie = tie_of(job.spec.place, job.id.index);
  prefer_begun();
  return apply(labels_.insert(ready), own);
}

void ReadyJobs::rekey(JobThread& job, Nanoseconds remaining) noexcept {
  prefer_begun();
  (void)apply(labels_.rekey(job.id, urgency_of(job, deadline_of(job), remaining)), nullptr);
}

// Threads that wake at one instant come one after the other: the first has not begun when the others come.
void ReadyJobs::prefer_begun() noexcept {
  const JobThread* const top = most_urgent();
  labels_.dispatch(top != nullptr && !top->phase.is_ready() ? top->id : TaskId());
}

int ReadyJobs::apply(std::span<const LevelChange> changes, const JobThread* own) noexcept {
  int level = place_.ceiling;
  for (const LevelChange& change : changes) {
    const JobThread& job = *of_task_[change.task.index];
    if (&job == own) {
      level = change.level;
      continue;
    }
    if (!has_levels_ || job.phase.has_ended()) continue;  // one that has ended is on its way to the ceiling
    ++level_changes_;
    set_level(job.carrier, change.level);
  }
  return level;
}

Urgency ReadyJobs::urgency_of(const JobThread& job, Nanoseconds deadline, Nanoseconds remaining) const noexcept {
  if (policy() == Policy::kMufLaxity)  // else noise would decide which job is more urgent
    remaining = deadline - rounded(deadline - remaining, place_.quantum);
  const TaskSpec& s = job.spec;
  return {s.criticality, s.user_priority, s.period, deadline, remaining};
}

JobThread* ReadyJobs::most_urgent_running() noexcept {
  for (std::size_t i = size(); i-- > 0;)
    if (JobThread& job = (*this)[i]; job.phase.is_running()) return &job;
  return nullptr;
}

void ReadyJobs::attach_thread() noexcept {
  if (has_levels_) (void)enter_realtime({place_.ceiling, place_.cpu, false});
}

void ReadyJobs::raise() noexcept {
  if (has_levels_) set_level(0, place_.ceiling);
}

void ReadyJobs::lower(int level) noexcept {
  if (has_levels_) set_level(0, level);
}

void ReadyJobs::raise(const JobThread& job) noexcept {
  if (has_levels_) set_level(job.carrier, place_.ceiling);
}

void ReadyJobs::lower_below_all(const JobThread& job) noexcept {
  if (has_levels_) set_below_all(job.carrier);
}

std::size_t ReadyJobs::count_wrong() const noexcept {
  std::size_t wrong = 0;
  const auto jobs = labels_.jobs();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const JobThread& job = *of_task_[jobs[i].task.index];
    const bool ascends = i == 0 || i < labels_.parked() || jobs[i].level > jobs[i - 1].level;
    const bool is_ordered = i == 0 || !is_more_urgent(labels_.policy(), jobs[i - 1].urgency, jobs[i].urgency);
    const bool is_at_label = !has_levels_ || job.phase.has_ended() || level_of(job.carrier) == jobs[i].level;
    if (!ascends || !is_ordered || !is_at_label) ++wrong;
  }
  return wrong;
}

}  // namespace chimera
