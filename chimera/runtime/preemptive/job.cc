// SPDX-License-Identifier: Apache-2.0
// The thread of a task: sleeps until its release, runs the job at its label, tells that it ended.
#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera {
namespace {

constexpr Nanoseconds kShowEvery = milliseconds(10);

}  // namespace

void PreemptiveExecutor::follow_releases(JobThread& me) {
  if (has_levels_) (void)enter_realtime({place_.ceiling, place_.cpu, false});
  section_.enter();
  me.id = me.carrier = this_thread();
  while (!quits_) {
    const Nanoseconds now = clock_.now();
    const bool may_run = me.is_joined && !me.is_held && !is_paused_ && me.next < until_;
    if (may_run && me.next <= now) {
      run_job(me, now);
      continue;
    }
    const std::uint32_t heard = Doorbell(me.bell).read();
    const Nanoseconds until = may_run ? me.next : kNever;
    section_.leave();
    (void)Doorbell(me.bell).wait_until(heard, until);
    section_.enter();
  }
  section_.leave();
}

// In the section, and in it again afterwards.
void PreemptiveExecutor::run_job(JobThread& me, Nanoseconds now) noexcept {
  charge_running(now);
  if (!release(me, now)) return;
  const int level = enter_label(me, now);
  const bool is_first = &of_task_[labels_.jobs().back().task.index][0] == &me;
  section_.leave();
  lower(level);
  if (begin(me)) {
    now = run_body(me, is_first ? now : clock_.now());
    raise();
    section_.enter();
    end(me, now);
    return;
  }
  section_.enter();  // cancelled: whoever did that has raised this thread
  me.phase = JobPhase::kNone;
}

// Takes the newest release that has come; what came before it is dropped. False: nothing may begin.
bool PreemptiveExecutor::release(JobThread& me, Nanoseconds now) noexcept {
  const TaskSpec& s = spec(me);
  const std::int64_t passed = (now - me.next) / s.period;
  const Nanoseconds release = me.next + s.period * passed;
  if (passed > 0) releases_.drop({me.task, release - s.period, static_cast<std::uint32_t>(passed)});
  if (releases_.has_lost_patience()) {
    me.is_held = true;  // until the edge has looked at it
    ring_edge();
    return false;
  }
  me.next = release + s.period;
  me.job = {me.task, release, release + s.deadline};
  me.illegal = releases_.is_illegal();
  me.is_overrun = false;
  task(me).give_up.store(false, std::memory_order_relaxed);
  if (set_.adopt(me.task)) ring_edge();
  return true;
}

// The job joins those that are ready; at which level, is for its thread to do.
int PreemptiveExecutor::enter_label(JobThread& me, Nanoseconds now) noexcept {
  const TaskSpec& s = spec(me);
  me.phase = JobPhase::kWaiting;
  task(me).is_busy = true;
  LabelledJob job;
  job.task = me.task;
  job.urgency = urgency_of(me, s.budget);
  const auto changes = labels_.insert(job);
  if (labels_.jobs().back().task == me.task) slice_of_running_ends(now, me);
  const int level = apply(changes, &me);
  Nanoseconds check = std::min(me.next, me.job.deadline);
  if (acts_at_once(s.on_overrun) && s.budget > Nanoseconds{}) check = std::min(check, now + s.budget);
  watch(me, check);
  return level;
}

bool PreemptiveExecutor::begin(JobThread& me) noexcept {
  JobPhase phase = JobPhase::kWaiting;
  if (me.phase.compare_exchange_strong(phase, JobPhase::kBegun)) return true;
  section_.enter();  // the supervisor was changing the job; or it is cancelled
  const bool begins = me.phase == JobPhase::kWaiting;
  if (begins) me.phase = JobPhase::kBegun;
  section_.leave();
  return begins;
}

// Returns when it ended.
Nanoseconds PreemptiveExecutor::run_body(JobThread& me, Nanoseconds start) noexcept {
  const Job job = me.job;
  me.slice = start;
  const Nanoseconds before = used_by_this_thread();
  me.used_before.store(before.count, std::memory_order_relaxed);
  Nanoseconds end = start;
  if (releases_.may_start(job, start)) {
    CycleTime time;
    const BodyEnd body = releases_.begin_job(job, time, me.illegal);
    end = clock_.now();
    releases_.conclude_job(job, time, body, start, end, used_by_this_thread() - before);
  }
  me.phase = JobPhase::kDone;
  return end;
}

void PreemptiveExecutor::end(JobThread& me, Nanoseconds now) noexcept {
  ++counts_.jobs;
  const bool was_running = labels_.size() > 0 && labels_.jobs().back().task == me.task;
  if (!was_running && !me.is_demoted) ++counts_.ended_unseen;
  if (now > me.slice && !me.is_demoted)
    releases_.record_now(TapKind::kRun, me.slice, me.task, CHIMERA_CYCLE, (now - me.slice).count);
  (void)apply(labels_.remove(me.task), nullptr);
  me.phase = JobPhase::kNone;
  me.is_demoted = false;
  me.check = kNever;
  Task& t = task(me);
  t.is_busy = false;
  releases_.flush_records(me.task);
  if (was_running) running_goes_on(now);
  if (guest_ != nullptr && now - me.shown >= kShowEvery) {
    me.shown = now;
    guest_->show(t);
  }
  if (t.state != State::kOn) me.is_joined = false;  // the edge will say so too
  if (releases_.is_unsettled(me.task) || !t.pending.empty() || is_paused_) ring_edge();
}

// `by` is about to take the processor.
void PreemptiveExecutor::slice_of_running_ends(Nanoseconds now, const JobThread& by) noexcept {
  for (std::size_t i = labels_.size(); i-- > 0;) {
    JobThread& job = *of_task_[labels_.jobs()[i].task.index];
    if (&job == &by || job.phase != JobPhase::kBegun) continue;
    if (now > job.slice)
      releases_.record_now(TapKind::kRun, job.slice, job.task, CHIMERA_CYCLE, (now - job.slice).count);
    releases_.record_now(TapKind::kPreempt, now, job.task, 0);
    job.slice = now;
    ++task(job).profile.preempted;
    ++counts_.preemptions;
    return;
  }
}

// Who was preempted has the processor again; whoever has not begun says so himself.
void PreemptiveExecutor::running_goes_on(Nanoseconds now) noexcept {
  JobThread* next = running();
  if (next != nullptr) next->slice = now;
  const std::uint32_t word = next == nullptr ? 0 : (next->task.index + 1) << 8 | CHIMERA_CYCLE;
  tasks_[0].running->store(word, std::memory_order_relaxed);
}

}  // namespace chimera
