// SPDX-License-Identifier: Apache-2.0
// Checks of jobs while they wait and run: deadlines, budgets, capacities, the share of the processor, hanging threads.
#include "chimera/runtime/preemptive/supervisor.h"

#include <algorithm>
#include <utility>

#include "chimera/runtime/job/hang_rule.h"

namespace chimera {
namespace {

// Least time between two alarms: the supervisor runs at the ceiling and keeps every job from running.
constexpr Nanoseconds kMinAlarmGap = microseconds(5);
// How often the share is checked while no job is found that may be demoted.
constexpr Nanoseconds kMinShareGap = milliseconds(1);

}  // namespace

Supervisor::Supervisor(Releases& releases, ReadyJobs& ready, ProcessorShare& share, JobChecks& checks,
                       Processor& processor, JobClock& clock)
    : releases_(releases), ready_(ready), share_(share), checks_(checks), processor_(processor), clock_(clock) {
  for (const JobThread& job : ready.threads()) seen_.resize(std::max<std::size_t>(seen_.size(), job.id.index + 1));
}

void Supervisor::start(std::atomic<std::size_t>& n_attached) {
  thread_ = std::thread([this, &n_attached] { run(n_attached); });
}

void Supervisor::quit() noexcept {
  quits_.store(true, std::memory_order_relaxed);
  checks_.ring();
}

void Supervisor::run(std::atomic<std::size_t>& n_attached) noexcept {
  ready_.attach_thread();
  n_attached.fetch_add(1, std::memory_order_release);  // pairs with the load of the thread that starts these
  for (bool is_over = false; !is_over;) {
    checks_.wait();
    processor_.enter();
    ++processor_.counts().supervised;
    is_over = quits_.load(std::memory_order_relaxed);
    if (!is_over) check_jobs(clock_.now());
    processor_.leave();
  }
}

void Supervisor::check_jobs(Nanoseconds now) noexcept {
  check_running(now);
  Nanoseconds next = kNever;
  for (JobThread& job : ready_.threads()) {
    if (checks_.due(job) <= now) check(job, now);
    next = std::min(next, checks_.due(job));
  }
  if (ready_.size() == 0) next = std::min(next, next_late(now));
  if (next != kNever) next = std::max(next, now + kMinAlarmGap);
  if (ready_.policy() == Policy::kMufLaxity && ready_.size() > 1) next = std::min(next, processor_.next_quantum(now));
  checks_.rearm(next);
  keep_share(now, nullptr);
}

// When a job that is to come would be seen to be late, if it were alone.
Nanoseconds Supervisor::next_late(Nanoseconds now) const noexcept {
  Nanoseconds next = kNever;
  for (const JobThread& job : std::as_const(ready_).threads()) {
    const bool comes = job.is_on && !job.sporadic && job.phase.is_idle() && job.takes_release();
    const Nanoseconds late = comes ? job.next_release + job.spec.deadline + JobChecks::kCoalesceWindow : kNever;
    if (late > now) next = std::min(next, late);  // else something keeps the job from being released
  }
  return next;
}

void Supervisor::check(JobThread& job, Nanoseconds now) noexcept {
  if (job.phase.try_claim()) return check_claimed(job, now);
  if (job.phase.is_running()) return check_begun(job, now);
  checks_.clear(job);
}

// The deadline of the job, or its next release, came before it was dispatched.
void Supervisor::check_claimed(JobThread& job, Nanoseconds now) noexcept {
  if (job.sporadic) {
    follow_server(job, now);
    return job.phase.unclaim();
  }
  if (now >= job.job.deadline) report_late(job, false);
  const bool is_expired = job.spec.on_miss == OnMiss::kAbort && now >= job.job.deadline;
  if (is_expired) releases_.misses().expire_unstarted(job.job);
  else if (now >= job.next_release && job.takes_release()) follow_release(job, now);
  const bool is_starved = releases_.misses().has_lost_patience();
  if (is_starved) {
    job.is_held = true;
    processor_.edge_bell().ring();
  }
  if (is_expired || is_starved) return processor_.cancel(job, now);
  job.phase.unclaim();
  const Nanoseconds next = job.takes_release() ? job.next_release : kNever;
  checks_.set(job, now < job.job.deadline ? std::min(next, job.job.deadline) : next);
}

// The job takes the newest release that has come; the one it had is dropped, and those in between.
void Supervisor::follow_release(JobThread& job, Nanoseconds now) noexcept {
  const TaskSpec& s = job.spec;
  const Nanoseconds release = job.newest_release(now);
  const std::int64_t passed = (release - job.next_release) / s.period;
  releases_.misses().drop({job.id, release - s.period, static_cast<std::uint32_t>(passed + 1)});
  job.job = {job.id, release, release + s.deadline};
  releases_.misses().forget_reports(job.id);
  job.next_release = release + s.period;
  ready_.rekey(job, s.budget);
  processor_.dispatch(now);
}

void Supervisor::check_begun(JobThread& job, Nanoseconds now) noexcept {
  const TaskSpec& s = job.spec;
  charge(job, now);
  if (!job.phase.is_running()) return;  // its thread is gone, or it has just ended
  const bool is_late = now >= job.job.deadline;
  if (is_late) report_late(job, true);
  if (is_late && s.on_miss == OnMiss::kDemote) processor_.demote(job, now);
  if (is_late && s.on_miss == OnMiss::kAbort) job.task.give_up.store(true, std::memory_order_relaxed);
  if (job.sporadic && !job.is_demoted) return follow_server(job, now);
  Nanoseconds next = is_late || job.sporadic ? now + s.period : job.job.deadline;
  if (&job == processor_.on_processor()) next = std::min(next, processor_.end_of_budget(job, now));
  checks_.set(job, next);
}

// If the most urgent job has not begun yet, no other job of the list has run since the last check.
void Supervisor::check_running(Nanoseconds now) noexcept {
  JobThread* const top = ready_.most_urgent();
  if (top != nullptr && top->phase.is_running()) charge(*top, now);
}

void Supervisor::charge(JobThread& job, Nanoseconds now) noexcept {
  const TaskSpec& s = job.spec;
  const bool has_budget = s.budget > Nanoseconds{};
  if (!has_budget && !job.sporadic && now < job.job.deadline) return;
  const Nanoseconds all = used_by(job.thread());
  if (all == kNever) return reap(job, now);
  const Nanoseconds used = all - job.used_before();
  if (hangs(s, used, slept(job, used, now))) return give_up(job, used, now);
  if (has_budget && used > s.budget && !releases_.misses().is_reported_overrun(job.id)) return overrun(job, now);
  if (ready_.policy() != Policy::kMufLaxity || job.is_demoted) return;
  ready_.rekey(job, std::max(s.budget - used, Nanoseconds{}));
  processor_.dispatch(now);
}

// The overrun was seen while the job still runs. Some reactions act at once, the others at its end.
void Supervisor::overrun(JobThread& job, Nanoseconds now) noexcept {
  if (!releases_.misses().report_overrun(job.id, job.cycle, job.used(), now)) return;
  const OnMiss reaction = job.spec.on_overrun;
  if (reaction == OnMiss::kDemote) processor_.demote(job, now);
  if (reaction == OnMiss::kAbort) job.task.give_up.store(true, std::memory_order_relaxed);
  if (releases_.settlement().is_unsettled(job.id)) processor_.edge_bell().ring();
}

// The deadline of the job has come; how late the job is, is known at its end.
void Supervisor::report_late(const JobThread& job, bool has_begun) noexcept {
  releases_.misses().report_late(job.job, has_begun);
  if (releases_.settlement().is_unsettled(job.id)) processor_.edge_bell().ring();
}

// Time for which the job used nothing while no more urgent one had the processor, up to this look.
Nanoseconds Supervisor::slept(const JobThread& job, Nanoseconds used, Nanoseconds now) noexcept {
  Seen& last = seen(job);
  const Nanoseconds period = job.spec.period, since = std::min(now - last.at, period);
  const bool is_asleep = used == last.used && (job.is_demoted || &job == ready_.most_urgent_running());
  if (used != last.used) last.slept = {};
  if (is_asleep) last.slept += since;
  last.used = used;
  last.at = now;
  return last.slept;
}

// The other jobs keep their deadlines. The owner of the context ends the context, because nothing else ends the job.
void Supervisor::give_up(JobThread& job, Nanoseconds used, Nanoseconds now) noexcept {
  Seen& of_job = seen(job);
  if (of_job.is_given_up) return;
  of_job.is_given_up = of_job.is_unreported = true;
  processor_.demote(job, now);
  releases_.tap().record_now(TapKind::kHang, now, job.id, job.cycle, used.count);
  processor_.edge_bell().ring();
}

// The thread ended in the body, so the supervisor reports the end of the job. Its task has no thread any more.
void Supervisor::reap(JobThread& job, Nanoseconds now) noexcept {
  job.phase.lose_thread();
  checks_.clear(job);
  seen(job).is_unreported = true;
  releases_.jobs().close(job.id);
  ready_.remove(job);
  processor_.dispatch(now);
  releases_.tap().record_now(TapKind::kHang, now, job.id, job.cycle);
  processor_.edge_bell().ring();
}

bool Supervisor::pop_hanging(const JobThread& job) noexcept { return std::exchange(seen(job).is_unreported, false); }

void Supervisor::forget(const JobThread& job) noexcept { seen(job).is_given_up = false; }

void Supervisor::watch_released(JobThread& job, Nanoseconds now) noexcept {
  Seen& of_job = seen(job);
  of_job.at = job.job.release;
  of_job.slept = {};
  Nanoseconds check = job.sporadic ? processor_.next_server_check(job, now)
                                   : std::min(job.next_release, job.job.deadline);
  if (JobChecks::acts_at_end_of_budget(job.spec)) check = std::min(check, now + job.spec.budget);
  if (ready_.policy() == Policy::kMufLaxity && ready_.size() > 1) check = std::min(check, processor_.next_quantum(now));
  checks_.watch(job, check, ready_.size());
}

// For a job that is ready, runs or is halted. The capacity of its server decides its place, and until when.
void Supervisor::follow_server(JobThread& job, Nanoseconds now) noexcept {
  SporadicThread& server = *job.sporadic;
  server.charge(job.thread(), job.is_demoted);
  const SporadicJob::Grant grant = server.job().grant(now);
  const bool has_begun = job.phase.is_running();
  if (has_begun && !grant.may_run && !server.is_halted()) {
    server.halt();
    ++job.task.profile.exhausted;
    ready_.remove(job);
    processor_.dispatch(now);
  } else if (has_begun && grant.may_run && server.is_halted()) {
    (void)ready_.insert(job, server.job().deadline(), job.spec.budget, nullptr);
    processor_.dispatch(now);
    server.resume();
  } else if (grant.has_another_deadline && !server.is_halted()) {
    ready_.rekey(job, job.spec.budget);
    processor_.dispatch(now);
  }
  checks_.set(job, processor_.next_server_check(job, now));
}

// Less important tasks may use the time that the others do not need. One of the others is demoted only if they alone
// use too much, the least urgent first.
void Supervisor::keep_share(Nanoseconds now, const JobThread* own) noexcept {
  if (!share_.is_limited() || ready_.size() == 0) return;
  const Nanoseconds left = share_.left(now);
  for (std::size_t i = 0; left <= Nanoseconds{} && i < ready_.size(); ++i) {
    JobThread& job = ready_[i];
    const bool is_there = &job != own && (job.phase.is_ready() || job.phase.is_running());
    const bool is_most_urgent = i + 1 == ready_.size();
    const bool is_over_budget = releases_.misses().is_reported_overrun(job.id);
    if (!is_there || !share_.may_demote(job.id, is_over_budget, is_most_urgent, now)) continue;
    demote_for_share(job, now);
    break;
  }
  checks_.arm_by(now + std::max(left, kMinShareGap));
}

void Supervisor::demote_for_share(JobThread& job, Nanoseconds now) noexcept {
  const bool is_claimed = job.phase.try_claim();
  if (!is_claimed && !job.phase.is_running()) return;
  processor_.demote(job, now);
  if (is_claimed) job.phase.unclaim();
  if (share_.note_demoted(job.id, now)) processor_.edge_bell().ring();
}

}  // namespace chimera
