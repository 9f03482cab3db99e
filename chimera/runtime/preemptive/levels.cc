// SPDX-License-Identifier: Apache-2.0
// Levels: what the list of labels says is told to the kernel here, and with checks compared with what it does.
#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera {
namespace {

Nanoseconds rounded(Nanoseconds t, Nanoseconds quantum) noexcept {
  return quantum * ((t.count + quantum.count / 2) / quantum.count);
}

}  // namespace

void PreemptiveExecutor::raise() noexcept {
  if (has_levels_) set_level(0, place_.ceiling);
}

void PreemptiveExecutor::lower(int level) noexcept {
  if (has_levels_) set_level(0, level);
}

// Tells the kernel what changed; the level of `own` is returned instead, for its thread to take as the last thing.
int PreemptiveExecutor::apply(std::span<const LevelChange> changes, const JobThread* own) noexcept {
  int level = place_.ceiling;
  for (const LevelChange& change : changes) {
    const JobThread& job = *of_task_[change.task.index];
    if (&job == own) {
      level = change.level;
      continue;
    }
    // One that is done is on its way into the section, at the ceiling.
    if (!has_levels_ || job.phase == JobPhase::kDone) continue;
    ++counts_.level_changes;
    set_level(job.carrier, change.level);
  }
  return level;
}

Urgency PreemptiveExecutor::urgency_of(const JobThread& job, Nanoseconds remaining) const noexcept {
  const TaskSpec& s = spec(job);
  const Nanoseconds due = job.served ? job.served->due : job.job.deadline;
  Urgency urgency{s.criticality, s.user_priority, s.period, due, remaining};
  if (labels_.policy() == Policy::kMufLaxity)  // else noise would decide who is more urgent
    urgency.remaining = due - rounded(due - remaining, place_.quantum);
  return urgency;
}

// What the list says and what the kernel does are the same, but for those on their way to the ceiling.
void PreemptiveExecutor::check() noexcept {
  ++counts_.checked;
  taken_before_ = section_.times_taken();
  sleeps_before_ = sleeps_of_this_thread();
  const auto jobs = labels_.jobs();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const JobThread& job = *of_task_[jobs[i].task.index];
    const bool ascends = i == 0 || i < labels_.parked() || jobs[i].level > jobs[i - 1].level;
    const bool is_ordered = i == 0 || !is_more_urgent(labels_.policy(), jobs[i - 1].urgency, jobs[i].urgency);
    const bool is_at_label = !has_levels_ || job.phase == JobPhase::kDone || level_of(job.carrier) == jobs[i].level;
    if (!ascends || !is_ordered || !is_at_label) ++counts_.wrong_levels;
  }
}

// Nothing in the section waits for anything; a holder that slept nevertheless waited for memory.
void PreemptiveExecutor::check_holder() noexcept {
  const std::uint64_t taken = section_.times_taken() - taken_before_;
  if (taken > 0 && sleeps_of_this_thread() != sleeps_before_) counts_.taken_asleep += taken;
}

// The most urgent job that has begun: it has the processor, unless it sleeps in a system call.
JobThread* PreemptiveExecutor::running() noexcept {
  for (std::size_t i = labels_.size(); i-- > 0;) {
    JobThread& job = *of_task_[labels_.jobs()[i].task.index];
    if (job.phase == JobPhase::kBegun) return &job;
  }
  return nullptr;
}

}  // namespace chimera
