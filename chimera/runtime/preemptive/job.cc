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
  me.id = me.carrier = this_thread();
  if (me.served) me.served->halt.attach();
  ++n_ready_;
  enter();
  for (;;) {
    const std::uint32_t heard = me.bell.read();  // before the look at everything: no ring is lost
    if (quits_) break;
    const Nanoseconds now = clock_.now();
    if (me.served) take_event(me, now);
    const bool may_run = me.is_joined && !me.is_held && !is_paused_ && me.next < until_;
    if (may_run && me.next <= now) {
      run_job(me, now);
      continue;
    }
    const Nanoseconds until = may_run ? me.next : kNever;
    const int descriptor = listens(me) ? task(me).descriptor : -1;
    leave();
    const bool has_come = descriptor >= 0 && me.served->bell.await(descriptor, kNever);
    if (descriptor < 0) (void)me.bell.wait_until(heard, until);
    enter();
    if (has_come && listens(me)) (void)set_.sent().ring(me.task);
  }
  leave();
}

// In the section, and in it again afterwards.
void PreemptiveExecutor::run_job(JobThread& me, Nanoseconds now) noexcept {
  charge_running(now);
  if (!release(me, now)) return;
  const int level = enter_label(me, now);
  leave();
  lower(level);
  me.used_before.store(used_by_this_thread().count, std::memory_order_relaxed);
  if (begin(me)) {
    now = run_body(me);
    raise();
    enter();
    end(me, now);
    return;
  }
  enter();  // cancelled: whoever did that has raised this thread
  me.phase = JobPhase::kNone;
}

// Takes the newest release that has come; what came before it is dropped. False: nothing may begin.
bool PreemptiveExecutor::release(JobThread& me, Nanoseconds now) noexcept {
  const TaskSpec& s = spec(me);
  if (me.served) {  // nothing is due at an instant but the server
    prepare(me, {me.task, me.served->taken, kNever});
    return true;
  }
  const std::int64_t passed = (newest_instant(now) - me.next) / s.period;
  const Nanoseconds release = me.next + s.period * passed;
  if (passed > 0) releases_.misses().drop({me.task, release - s.period, static_cast<std::uint32_t>(passed)});
  if (releases_.misses().has_lost_patience()) {
    me.is_held = true;  // until the edge has looked at it
    ring_edge();
    return false;
  }
  me.next = release + s.period;
  prepare(me, {me.task, release, release + s.deadline});
  return true;
}

void PreemptiveExecutor::prepare(JobThread& me, const Job& job) noexcept {
  me.job = job;
  me.cycle = task(me).call.cycle;
  me.illegal = releases_.is_illegal();
  me.is_demoted = false;
  releases_.jobs().open(me.task);
  me.seen_at = job.release;
  me.slept = {};
  task(me).give_up.store(false, std::memory_order_relaxed);
  if (set_.adopt(me.task)) ring_edge();
}

// The job joins those that are ready; at which level, is for its thread to do.
int PreemptiveExecutor::enter_label(JobThread& me, Nanoseconds now) noexcept {
  const TaskSpec& s = spec(me);
  me.phase = JobPhase::kWaiting;
  LabelledJob job;
  job.task = me.task;
  job.urgency = urgency_of(me, s.budget);
  const auto changes = labels_.insert(job);
  const int level = apply(changes, &me);
  processor_goes_on(now);
  Nanoseconds check = me.served ? next_look_at_server(me, now) : std::min(me.next, me.job.deadline);
  if (acts_at_once(s.on_overrun) && s.budget > Nanoseconds{}) check = std::min(check, now + s.budget);
  if (labels_.policy() == Policy::kMufLaxity && labels_.size() > 1) check = std::min(check, next_quantum(now));
  watch(me, check);
  keep_share(now, &me);
  return level;
}

bool PreemptiveExecutor::begin(JobThread& me) noexcept {
  JobPhase phase = JobPhase::kWaiting;
  if (me.phase.compare_exchange_strong(phase, JobPhase::kBegun)) return true;
  enter();  // the supervisor was changing the job; or it is cancelled
  const bool begins = me.phase == JobPhase::kWaiting;
  if (begins) me.phase = JobPhase::kBegun;
  leave();
  return begins;
}

// Returns when it ended.
Nanoseconds PreemptiveExecutor::run_body(JobThread& me) noexcept {
  const Job job = me.job;
  const Nanoseconds before{me.used_before.load(std::memory_order_relaxed)};
  if (sees_switches_) SwitchWatch::begin();
  const Nanoseconds start = clock_.now();
  me.slice.store(start.count, std::memory_order_relaxed);
  if (me.served) me.served->halt.open();
  Nanoseconds end = start;
  if (releases_.jobs().may_start(job, start)) {
    CycleTime time;
    const BodyEnd body = releases_.jobs().begin(job, time, me.illegal);
    end = clock_.now();
    const bool kept_processor = sees_switches_ && SwitchWatch::end();
    const Nanoseconds used = kept_processor ? end - start : used_by_this_thread() - before;
    releases_.jobs().conclude(job, time, body, start, end, used);
  }
  if (me.served) me.served->halt.close();
  me.phase = JobPhase::kDone;
  return end;
}

void PreemptiveExecutor::end(JobThread& me, Nanoseconds now) noexcept {
  ++counts_.jobs;
  const bool was_running = labels_.size() > 0 && labels_.jobs().back().task == me.task;
  if (!was_running && !me.is_demoted) ++counts_.ended_unseen;
  if (!me.is_demoted) record_slice(me, now);
  (void)apply(labels_.remove(me.task), nullptr);
  if (me.served) end_served(me);
  me.phase = JobPhase::kNone;
  me.is_demoted = me.is_given_up = false;
  me.check = kNever;
  Task& t = task(me);
  releases_.jobs().close(me.task);
  releases_.tap().flush(me.task);
  processor_goes_on(now);
  put_off_alarm(now);
  me.is_shown = false;
  if (me.served || now - me.shown >= kShowEvery) show(me, now);  // another event may never come
  if (t.state != State::kOn) me.is_joined = false;  // the edge will say so too
  if (me.is_awaited) me.is_held = true;  // until the edge has looked: the next job may be due already
  if (me.is_awaited || releases_.settlement().is_unsettled(me.task) || !t.pending.empty() || is_paused_) ring_edge();
  me.is_awaited = false;
}

void PreemptiveExecutor::record_slice(const JobThread& job, Nanoseconds now) noexcept {
  const Nanoseconds since{job.slice.load(std::memory_order_relaxed)};
  if (now > since) releases_.tap().record_now(TapKind::kRun, since, job.task, CHIMERA_CYCLE, (now - since).count);
}

// After every change of the list: whoever is the most urgent now has the processor. One that begins says so himself.
void PreemptiveExecutor::processor_goes_on(Nanoseconds now) noexcept {
  JobThread* top = labels_.size() == 0 ? nullptr : of_task_[labels_.jobs().back().task.index];
  use_.set(top != nullptr, now);
  use_by_less_.set(top != nullptr && top->is_less_important, now);
  if (top == on_processor_) return;
  if (on_processor_ != nullptr && on_processor_->phase == JobPhase::kBegun && !on_processor_->is_demoted) {
    record_slice(*on_processor_, now);
    releases_.tap().record_now(TapKind::kPreempt, now, on_processor_->task, 0);
    const bool is_halted = on_processor_->served && on_processor_->served->is_halted;
    if (!is_halted) {
      ++task(*on_processor_).profile.preempted;
      ++counts_.preemptions;
    }
  }
  on_processor_ = top;
  const bool goes_on = top != nullptr && top->phase == JobPhase::kBegun;
  if (goes_on) {
    top->slice.store(now.count, std::memory_order_relaxed);
  }
  if (goes_on || (top != nullptr && top->served && top->phase == JobPhase::kWaiting)) {
    const Nanoseconds budget = goes_on ? end_of_budget(*top, now) : kNever;
    const Nanoseconds check = std::min(budget, end_of_capacity(*top, now));
    if (check < top->check) watch(*top, check);
  }
  show_running();
}

void PreemptiveExecutor::show(JobThread& job, Nanoseconds now) noexcept {
  job.shown = now;
  job.is_shown = true;
  if (guest_ != nullptr) guest_->show(task(job));
}

// Whoever asks what the unit does, or what it did when it died.
void PreemptiveExecutor::show_running() noexcept {
  const JobThread* top = on_processor_;
  const bool is_begun = top != nullptr && top->phase == JobPhase::kBegun;
  const std::uint32_t word = is_begun ? TaskWord(top->task, Method::kCycle).word() : 0;
  tasks_[0].running->store(word, std::memory_order_relaxed);
}

}  // namespace chimera
