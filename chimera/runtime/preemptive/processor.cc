// SPDX-License-Identifier: Apache-2.0
// Follows which job has the processor after each change of the ready list: for checks, records and profiles.
#include "chimera/runtime/preemptive/processor.h"

#include "chimera/runtime/task_word.h"

namespace chimera {

Processor::Processor(TaskSet& set, Releases& releases, ReadyJobs& ready, ProcessorShare& share, JobChecks& checks,
                     const ProcessorPlace& place)
    : tasks_(set.tasks()), releases_(releases), ready_(ready), share_(share), checks_(checks), place_(place),
      bell_(place.bell != nullptr ? place.bell : &own_bell_) {}

void Processor::dispatch(Nanoseconds now) noexcept {
  JobThread* const top = ready_.most_urgent();
  share_.set_running(top == nullptr ? TaskId() : top->id, now);
  if (top == on_processor_) return;
  if (on_processor_ != nullptr && on_processor_->phase.is_running() && !on_processor_->is_demoted)
    note_preempted(*on_processor_, now);
  on_processor_ = top;
  const bool goes_on = top != nullptr && top->phase.is_running();
  if (goes_on) top->begin_slice(now);  // a job that begins says so itself
  if (goes_on || (top != nullptr && top->sporadic && top->phase.is_ready())) {
    const Nanoseconds budget = goes_on ? end_of_budget(*top, now) : kNever;
    const Nanoseconds check = std::min(budget, JobChecks::end_of_capacity(*top, now));
    if (check < checks_.due(*top)) checks_.watch(*top, check, ready_.size());
  }
  show_running();
}

void Processor::note_preempted(const JobThread& job, Nanoseconds now) noexcept {
  record_slice(job, now);
  releases_.tap().record_now(TapKind::kPreempt, now, job.id, 0);
  if (job.sporadic && job.sporadic->is_halted()) return;
  ++job.task.profile.preempted;
  ++counts_.preemptions;
}

void Processor::demote(JobThread& job, Nanoseconds now) noexcept {
  if (job.is_demoted) return;
  if (job.phase.is_running()) record_slice(job, now);
  job.is_demoted = true;
  if (job.sporadic) job.sporadic->resume();
  ++job.task.profile.demoted;
  ready_.remove(job);
  dispatch(now);
  ready_.lower_below_all(job);
}

void Processor::cancel(JobThread& job, Nanoseconds now) noexcept {
  job.phase.cancel();
  checks_.clear(job);
  releases_.jobs().close(job.id);
  ready_.remove(job);
  dispatch(now);
  ready_.raise(job);
}

void Processor::record_slice(const JobThread& job, Nanoseconds now) noexcept {
  const Nanoseconds since = job.slice();
  if (now > since) releases_.tap().record_now(TapKind::kRun, since, job.id, CHIMERA_CYCLE, (now - since).count);
}

void Processor::show_running() noexcept {
  const bool is_begun = on_processor_ != nullptr && on_processor_->phase.is_running();
  const TaskWord word = is_begun ? TaskWord(on_processor_->id, on_processor_->method()) : TaskWord();
  tasks_[0].running->store(word.word(), std::memory_order_relaxed);
}

Nanoseconds Processor::end_of_budget(const JobThread& job, Nanoseconds now) noexcept {
  return checks_.end_of_budget(job, releases_.misses().is_reported_overrun(job.id), now);
}

Nanoseconds Processor::next_server_check(JobThread& job, Nanoseconds now) noexcept {
  const Nanoseconds change = job.sporadic->job().next_change(now);
  if (&job != on_processor_) return change;
  const bool is_begun = job.phase.is_running();
  const Nanoseconds end = is_begun ? end_of_budget(job, now) : kNever;
  return std::min({change, end, JobChecks::end_of_capacity(job, now)});
}

Nanoseconds Processor::next_quantum(Nanoseconds now) const noexcept {
  const Nanoseconds quantum = place_.quantum, behind_releases{quantum.count / 8};  // of jobs at the quantum itself
  const Nanoseconds first = releases_.origin() + behind_releases;
  return first + quantum * ((now - first) / quantum + 1);
}

ProcessorCounts Processor::seen() const noexcept {
  ProcessorCounts seen = counts_;
  seen.level_changes = ready_.level_changes();
  seen.section_taken = section_.times_taken() - counts_.taken_asleep;
  return seen;
}

void Processor::check() noexcept {
  ++counts_.checked;
  taken_before_ = section_.times_taken();
  sleeps_before_ = sleeps_of_this_thread();
  counts_.wrong_levels += ready_.count_wrong();
}

// Nothing in the section waits for anything; a holder that slept nevertheless waited for memory.
void Processor::check_holder() noexcept {
  const std::uint64_t taken = section_.times_taken() - taken_before_;
  if (taken > 0 && sleeps_of_this_thread() != sleeps_before_) counts_.taken_asleep += taken;
}

}  // namespace chimera
