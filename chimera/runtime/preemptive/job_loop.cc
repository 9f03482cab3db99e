// SPDX-License-Identifier: Apache-2.0
// From release to end: the job of a task, run by the thread of the task.
#include "chimera/runtime/preemptive/job_loop.h"

#include <algorithm>

#include "chimera/platform/thread.h"

namespace chimera {
namespace {

// Profiles are handed out this often at most, but for those of tasks that may have no next job.
constexpr Nanoseconds kShowGap = milliseconds(10);

}  // namespace

JobLoop::JobLoop(TaskSet& set, Releases& releases, ReadyJobs& ready, JobChecks& checks, Processor& processor,
                 Supervisor& supervisor, ThreadClock& clock, BoundaryListener* guest)
    : set_(set),
      releases_(releases),
      ready_(ready),
      checks_(checks),
      processor_(processor),
      supervisor_(supervisor),
      clock_(clock),
      guest_(guest),
      sees_switches_(SwitchWatch::can_tell()) {}

void JobLoop::run(JobThread& me, std::atomic<std::size_t>& n_attached) {
  ready_.attach_thread();
  me.attach();
  n_attached.fetch_add(1, std::memory_order_release);  // pairs with the load of the thread that starts these
  processor_.enter();
  for (;;) {
    const std::uint32_t heard = me.heard();  // before the look at everything: no ring is lost
    if (quits_) break;
    const Nanoseconds now = clock_.now();
    if (me.sporadic) accept_event(me, now);
    const bool may_run = me.is_on && !me.is_held && !processor_.is_paused();
    const bool is_due = me.next_release <= now;
    if (may_run && is_due && me.takes_release()) run_job(me, now);
    else wait(me, heard, may_run && !is_due ? me.next_release : kNever);
  }
  processor_.leave();
}

// Waits outside the section.
void JobLoop::wait(JobThread& me, std::uint32_t heard, Nanoseconds until) noexcept {
  const int descriptor = listens(me) ? me.task.descriptor : -1;
  processor_.leave();
  const bool has_come = descriptor >= 0 && me.sporadic->bell().await(descriptor, kNever);
  if (descriptor < 0) me.wait(heard, until);
  processor_.enter();
  if (has_come && listens(me)) (void)set_.sent().ring(me.id);
}

// A job behind a server is released when there is an event to answer and capacity for that.
void JobLoop::accept_event(JobThread& me, Nanoseconds now) noexcept {
  if (!me.is_on) return;
  SporadicJob& job = me.sporadic->job();
  me.next_release = kNever;
  if (!job.accept(me.task.events, now)) return;
  me.sporadic->charge(me.thread(), me.is_demoted);
  me.next_release = job.grant(now).may_run ? now : job.next_change(now);
}

// True if no event has come, and one that comes may be accepted at once. The descriptor stays readable until then.
bool JobLoop::listens(const JobThread& me) const noexcept {
  if (!me.sporadic || !me.is_on || me.is_held || processor_.is_paused()) return false;
  return me.task.descriptor >= 0 && !me.sporadic->job().has_event() && me.task.events == 0;
}

// Leaves the section while the body runs.
void JobLoop::run_job(JobThread& me, Nanoseconds now) noexcept {
  supervisor_.check_running(now);
  if (!accept_release(me, now)) return;
  const int level = make_ready(me, now);
  processor_.leave();
  ready_.lower(level);
  me.begin_use();
  if (begin(me)) {
    now = run_body(me);
    ready_.raise();
    processor_.enter();
    end(me, now);
    return;
  }
  processor_.enter();  // at the ceiling: the canceller of the job has raised this thread
  me.phase.acknowledge_cancel();
}

// Takes the newest release that has come, and drops those before it. False: no job may begin.
bool JobLoop::accept_release(JobThread& me, Nanoseconds now) noexcept {
  const TaskSpec& s = me.spec;
  if (me.sporadic) {  // nothing is due at an instant but the server
    prepare(me, {me.id, me.sporadic->job().release(), kNever});
    return true;
  }
  const Nanoseconds release = me.newest_release(now);
  const std::int64_t passed = (release - me.next_release) / s.period;
  if (passed > 0) releases_.misses().drop({me.id, release - s.period, static_cast<std::uint32_t>(passed)});
  if (releases_.misses().has_lost_patience()) {
    me.is_held = true;
    processor_.edge_bell().ring();
    return false;
  }
  me.next_release = release + s.period;
  prepare(me, {me.id, release, release + s.deadline});
  return true;
}

void JobLoop::prepare(JobThread& me, const Job& job) noexcept {
  me.job = job;
  me.cycle = me.task.call.cycle;
  me.is_illegal = releases_.is_illegal();
  me.is_demoted = false;
  me.begin_slice(kNever);
  releases_.jobs().open(me.id);
  me.task.give_up.store(false, std::memory_order_relaxed);
  if (set_.adopt(me.id)) processor_.edge_bell().ring();
}

// The job is one of those that are ready. Its level is for its thread to take.
int JobLoop::make_ready(JobThread& me, Nanoseconds now) noexcept {
  me.phase.release();
  const int level = ready_.insert(me, ReadyJobs::deadline_of(me), me.spec.budget, &me);
  processor_.dispatch(now);
  supervisor_.watch_released(me, now);
  supervisor_.keep_share(now, &me);
  return level;
}

// Outside the section, but for a second look.
bool JobLoop::begin(JobThread& me) noexcept {
  if (me.phase.try_begin()) return true;
  processor_.enter();
  const bool begins = me.phase.try_begin();
  processor_.leave();
  return begins;
}

// Outside the section. Returns when the body ended.
Nanoseconds JobLoop::run_body(JobThread& me) noexcept {
  const Job job = me.job;
  const Nanoseconds before = me.used_before();
  if (sees_switches_) SwitchWatch::begin();
  const Nanoseconds start = clock_.now();
  me.begin_first_slice(start);
  if (me.sporadic) me.sporadic->open();
  Nanoseconds end = start;
  if (releases_.jobs().may_start(job, start)) {
    CycleTime time;
    const BodyEnd body = releases_.jobs().begin(job, time, me.is_illegal);
    end = clock_.now();
    const bool kept_processor = sees_switches_ && SwitchWatch::end();
    const Nanoseconds used = kept_processor ? end - start : used_by_this_thread() - before;
    releases_.jobs().conclude(job, time, body, start, end, used);
  }
  if (me.sporadic) me.sporadic->close();
  me.phase.finish();
  return end;
}

void JobLoop::end(JobThread& me, Nanoseconds now) noexcept {
  ++processor_.counts().jobs;
  if (ready_.most_urgent() != &me && !me.is_demoted) ++processor_.counts().ended_unseen;
  if (!me.is_demoted) processor_.record_slice(me, now);
  ready_.remove(me);
  if (me.sporadic) me.sporadic->finish(me.thread(), me.is_demoted);
  me.phase.retire();
  me.is_demoted = false;
  supervisor_.forget(me);
  checks_.clear(me);
  releases_.jobs().close(me.id);
  releases_.tap().flush(me.id);
  processor_.dispatch(now);
  if (ready_.size() == 0) checks_.put_off(now);
  me.is_shown = false;
  if (me.sporadic || now - me.shown_at >= kShowGap) show(me, now);  // another event may never come
  if (me.task.state != State::kOn) me.is_on = false;  // the cycle boundary will set it, too
  if (me.is_awaited) me.is_held = true;  // until the cycle boundary has checked: the next job may be due already
  const bool leaves_something = releases_.settlement().is_unsettled(me.id) || !me.task.pending.empty();
  if (me.is_awaited || leaves_something || processor_.is_paused()) processor_.edge_bell().ring();
  me.is_awaited = false;
}

void JobLoop::show(JobThread& job, Nanoseconds now) noexcept {
  job.shown_at = now;
  job.is_shown = true;
  if (guest_ != nullptr) guest_->show(job.task);
}

}  // namespace chimera
