// SPDX-License-Identifier: Apache-2.0
// Who looks after jobs that use too much, come too late or never end.
#include <algorithm>

#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera {
namespace {

// A job that has used so many times its budget (without one: its period) does not end by itself.
constexpr std::int64_t kHangsAfter = 10;
// Nor does one that sleeps in system calls for so long, and for so many periods.
constexpr Nanoseconds kSleepsAtMost = seconds(2);
// The supervisor never comes again at once: at the ceiling it would keep everybody else from running.
constexpr Nanoseconds kSoonest = microseconds(5), kSeldom = microseconds(25);
// A job that is late may be seen so much later, where nobody waits for it; the alarm is put off a little before that.
constexpr Nanoseconds kLax = microseconds(600), kMargin = microseconds(150);

}  // namespace

Nanoseconds PreemptiveExecutor::next_quantum(Nanoseconds now) const noexcept {
  const Nanoseconds first = origin() + Nanoseconds{place_.quantum.count / 8};  // after what is released there
  return first + place_.quantum * ((now - first) / place_.quantum + 1);
}

bool PreemptiveExecutor::acts_at_once(OnMiss reaction) noexcept {
  return reaction == OnMiss::kDemote || reaction == OnMiss::kAbort || reaction == OnMiss::kStop ||
         reaction == OnMiss::kFlag;
}

Nanoseconds PreemptiveExecutor::used(const JobThread& job) const noexcept {
  const Nanoseconds all = used_by(job.id);
  if (all == kNever) return {};
  return all - Nanoseconds{job.used_before.load(std::memory_order_relaxed)};
}

// Where the most urgent job has not begun yet, nobody else of the list has run since the last look.
void PreemptiveExecutor::charge_running(Nanoseconds now) noexcept {
  if (labels_.size() == 0) return;
  JobThread& top = *of_task_[labels_.jobs().back().task.index];
  if (top.phase == JobPhase::kBegun) charge(top, now);
}

// Looks at what a job that has begun has used by now, and acts on it.
void PreemptiveExecutor::charge(JobThread& job, Nanoseconds now) noexcept {
  const TaskSpec& s = spec(job);
  const bool by_laxity = labels_.policy() == Policy::kMufLaxity;
  if (s.budget == Nanoseconds{} && !job.served && now < job.job.deadline) return;
  const Nanoseconds all = used_by(job.id);
  if (all == kNever) return bury(job, now);
  const Nanoseconds spent = all - Nanoseconds{job.used_before.load(std::memory_order_relaxed)};
  const Nanoseconds allowed = s.budget > Nanoseconds{} ? s.budget : s.period;
  if (spent > allowed * kHangsAfter || sleeps_for_ever(job, spent, now)) return hang(job, spent, now);
  const bool is_reported = releases_.misses().is_reported_overrun(job.task);
  if (s.budget > Nanoseconds{} && spent > s.budget && !is_reported) return overrun(job, now);
  if (!by_laxity || job.is_demoted) return;
  (void)apply(labels_.rekey(job.task, urgency_of(job, std::max(s.budget - spent, Nanoseconds{}))), nullptr);
  processor_goes_on(now);
}

// Seen while the job still runs: what can be done at once is done at once; the rest at its end.
void PreemptiveExecutor::overrun(JobThread& job, Nanoseconds now) noexcept {
  if (!releases_.misses().report_overrun(job.task, job.cycle, used(job), now)) return;
  const OnMiss reaction = spec(job).on_overrun;
  if (reaction == OnMiss::kDemote) demote(job, now);
  if (reaction == OnMiss::kAbort) task(job).give_up.store(true, std::memory_order_relaxed);
  if (releases_.settlement().is_unsettled(job.task)) ring_edge();
}

// Its deadline has come; how late it is, is for its end to say.
void PreemptiveExecutor::tell_late(const JobThread& job, bool has_begun) noexcept {
  releases_.misses().report_late(job.job, has_begun);
  if (releases_.settlement().is_unsettled(job.task)) ring_edge();
}

// It used nothing since the last look, and nobody more urgent had the processor.
bool PreemptiveExecutor::sleeps_for_ever(JobThread& job, Nanoseconds spent, Nanoseconds now) noexcept {
  const Nanoseconds period = spec(job).period, since = std::min(now - job.seen_at, period);
  const bool sleeps = spent == job.seen_used && (job.is_demoted || &job == running());
  if (spent != job.seen_used) job.slept = {};
  if (sleeps) job.slept += since;
  job.seen_used = spent;
  job.seen_at = now;
  return job.slept > std::max(kSleepsAtMost, period * kHangsAfter);
}

// Its thread ended in the body: nobody else would say that the job is over, and its task has no thread any more.
void PreemptiveExecutor::bury(JobThread& job, Nanoseconds now) noexcept {
  job.phase = JobPhase::kNone;
  job.check = kNever;
  job.is_hanging = true;
  releases_.jobs().close(job.task);
  (void)apply(labels_.remove(job.task), nullptr);
  processor_goes_on(now);
  releases_.tap().record_now(TapKind::kHang, now, job.task, job.cycle);
  ring_edge();
}

// Others keep their deadlines; whoever runs the context ends it, for nothing else ends the job.
void PreemptiveExecutor::hang(JobThread& job, Nanoseconds spent, Nanoseconds now) noexcept {
  if (job.is_given_up) return;
  job.is_given_up = job.is_hanging = true;
  demote(job, now);
  releases_.tap().record_now(TapKind::kHang, now, job.task, job.cycle, spent.count);
  ring_edge();
}

void PreemptiveExecutor::demote(JobThread& job, Nanoseconds now) noexcept {
  if (job.is_demoted) return;
  if (job.phase == JobPhase::kBegun) record_slice(job, now);
  job.is_demoted = true;
  if (job.served && job.served->is_halted) job.served->halt.lift();
  ++task(job).profile.demoted;
  (void)apply(labels_.remove(job.task), nullptr);
  processor_goes_on(now);
  if (has_levels_) set_below_all(job.carrier);
}

// A job that waits is taken back; its thread goes to sleep again.
void PreemptiveExecutor::cancel(JobThread& job, Nanoseconds now) noexcept {
  job.phase = JobPhase::kCancelled;
  job.check = kNever;
  releases_.jobs().close(job.task);
  (void)apply(labels_.remove(job.task), nullptr);
  processor_goes_on(now);
  if (has_levels_) set_level(job.carrier, place_.ceiling);
}

// A job that is alone is looked at a little late: then one alarm does for several jobs. To set one for each would cost
// more than the rest of its release (it becomes the first timer of the CPU), and nobody waits for it.
Nanoseconds PreemptiveExecutor::alarm_for(Nanoseconds check, bool is_exact) const noexcept {
  return is_exact || labels_.size() > 1 ? check : check + kLax;
}

void PreemptiveExecutor::watch(JobThread& job, Nanoseconds check) noexcept {
  job.check = check;
  const TaskSpec& s = spec(job);
  const bool is_exact = (acts_at_once(s.on_overrun) && s.budget > Nanoseconds{}) || s.on_miss == OnMiss::kDemote ||
                        job.served.has_value();
  // A second job in the list: the first one's check counts from here on.
  if (is_lax_ && labels_.size() > 1) {
    for (const LabelledJob& other : labels_.jobs()) check = std::min(check, of_task_[other.task.index]->check);
    is_lax_ = false;
  }
  const Nanoseconds wanted = alarm_for(check, is_exact);
  is_lax_ = is_lax_ || wanted > check;
  if (wanted < armed_) arm(wanted);
}

// Nobody is ready: what the alarm was set for is over, but for jobs that are demoted or halted. No other job can be
// late before the shortest deadline has passed. To move the alarm here costs less than a look of the supervisor, and
// less than to set it at the next release, where somebody waits.
void PreemptiveExecutor::put_off_alarm(Nanoseconds now) noexcept {
  if (labels_.size() > 0 || armed_ > now + shortest_ + kMargin) return;
  Nanoseconds next = now + shortest_ + kLax;
  for (const JobThread& job : threads_) next = std::min(next, job.check);
  if (next > armed_) arm(next);
}

void PreemptiveExecutor::arm(Nanoseconds instant) noexcept {
  armed_ = instant;
  alarm_.set(instant);
}

void PreemptiveExecutor::supervise() {
  if (has_levels_) (void)enter_realtime({place_.ceiling, place_.cpu, false});
  ++n_ready_;
  while (!quits_) {
    alarm_.wait();
    enter();
    ++counts_.supervised;
    if (!quits_) look_at_jobs(clock_.now());
    leave();
  }
}

void PreemptiveExecutor::look_at_jobs(Nanoseconds now) noexcept {
  charge_running(now);
  Nanoseconds next = kNever;
  for (JobThread& job : threads_) {
    if (job.check <= now) look_at(job, now);
    next = std::min(next, job.check);
  }
  is_lax_ = false;
  if (labels_.size() == 0) next = std::min(next, next_late(now));
  if (next != kNever) next = std::max(next, now + kSoonest);
  if (labels_.policy() == Policy::kMufLaxity && labels_.size() > 1) next = std::min(next, next_quantum(now));
  arm(next);
  keep_share(now, nullptr);
}

// When a job that is to come would be seen to be late, if it were alone.
Nanoseconds PreemptiveExecutor::next_late(Nanoseconds now) const noexcept {
  Nanoseconds next = kNever;
  for (const JobThread& job : threads_) {
    const bool comes = job.is_joined && !job.served && job.phase == JobPhase::kNone && job.next < until_;
    const Nanoseconds late = comes ? job.next + spec(job).deadline + kLax : kNever;
    if (late > now) next = std::min(next, late);  // else something keeps it from being released
  }
  return next;
}

void PreemptiveExecutor::look_at(JobThread& job, Nanoseconds now) noexcept {
  JobPhase phase = JobPhase::kWaiting;
  if (job.phase.compare_exchange_strong(phase, JobPhase::kChanged)) return look_at_waiting(job, now);
  if (phase == JobPhase::kBegun) return look_at_begun(job, now);
  job.check = kNever;
}

// Its deadline, or its next release, came before it was dispatched.
void PreemptiveExecutor::look_at_waiting(JobThread& job, Nanoseconds now) noexcept {
  const TaskSpec& s = spec(job);
  if (job.served) {
    follow_server(job, now);
    job.phase = JobPhase::kWaiting;
    return;
  }
  if (now >= job.job.deadline) tell_late(job, false);
  if (s.on_miss == OnMiss::kAbort && now >= job.job.deadline) {
    releases_.misses().expire_unstarted(job.job);
    cancel(job, now);
  } else if (now >= job.next && job.next < until_) {
    const std::int64_t passed = (newest_instant(now) - job.next) / s.period;
    const Nanoseconds release = job.next + s.period * passed;
    releases_.misses().drop({job.task, release - s.period, static_cast<std::uint32_t>(passed + 1)});
    job.job = {job.task, release, release + s.deadline};
    releases_.misses().forget_reports(job.task);
    job.next = release + s.period;
    (void)apply(labels_.rekey(job.task, urgency_of(job, s.budget)), nullptr);
    processor_goes_on(now);
  }
  if (releases_.misses().has_lost_patience() && job.phase != JobPhase::kCancelled) cancel(job, now);
  if (releases_.misses().has_lost_patience()) {
    job.is_held = true;
    ring_edge();
  }
  if (job.phase == JobPhase::kCancelled) return;
  job.phase = JobPhase::kWaiting;
  const Nanoseconds next = job.next < until_ ? job.next : kNever;
  job.check = now < job.job.deadline ? std::min(next, job.job.deadline) : next;
}

void PreemptiveExecutor::look_at_begun(JobThread& job, Nanoseconds now) noexcept {
  const TaskSpec& s = spec(job);
  charge(job, now);
  if (job.phase != JobPhase::kBegun) return;  // its thread is gone
  const bool is_late = now >= job.job.deadline;
  if (is_late) tell_late(job, true);
  if (is_late && s.on_miss == OnMiss::kDemote) demote(job, now);
  if (is_late && s.on_miss == OnMiss::kAbort) task(job).give_up.store(true, std::memory_order_relaxed);
  if (job.served && !job.is_demoted) return follow_server(job, now);
  job.check = now < job.job.deadline && !job.served ? job.job.deadline : now + s.period;
  if (&job == on_processor_) job.check = std::min(job.check, end_of_budget(job, now));
}

// When a job that runs will have used up its budget, where that is to be seen at once; kNever otherwise. One that has
// used nothing since the last look sleeps in a system call: nobody waits for that at every instant.
Nanoseconds PreemptiveExecutor::end_of_budget(JobThread& job, Nanoseconds now) noexcept {
  const TaskSpec& s = spec(job);
  const bool is_reported = releases_.misses().is_reported_overrun(job.task);
  if (!acts_at_once(s.on_overrun) || s.budget == Nanoseconds{} || is_reported) return kNever;
  const Nanoseconds spent = used(job), last = job.charged;
  job.charged = spent;
  return now + std::max(s.budget - spent, spent == last ? kSeldom : kSoonest);
}

}  // namespace chimera
