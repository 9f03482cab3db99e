// SPDX-License-Identifier: Apache-2.0
// Tasks behind servers: an event releases a job, one after the other; it is as urgent as its server. A job that has
// not begun waits for capacity like one that has no event: its thread sleeps. One that runs out of it is halted, and
// goes on at its label when some is back. The server pays for all that the thread uses, its way to the label included:
// events that come in a storm cost the others no more than the capacity.
#include <algorithm>

#include "chimera/platform/realtime.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera {
namespace {

// The supervisor comes again no sooner: at the ceiling it would keep the job itself from using up the rest.
constexpr Nanoseconds kSoonest = microseconds(25);
// What is not worth a halt any more, of the capacity but never more than a quarter of it.
constexpr Nanoseconds kSliver = microseconds(25);

// How long the job may run from now on. A sliver counts as used: it comes back with the rest.
Nanoseconds capacity_of(ServerState& server, const ServerSpec& spec, Nanoseconds now) noexcept {
  const Nanoseconds sliver = std::min(kSliver, Nanoseconds{spec.capacity.count / 4});
  server.follow(now);
  Nanoseconds left = server.allowance(now);
  for (std::size_t i = 0; i < ServerState::kPieces && left > Nanoseconds{} && left < sliver; ++i) {
    server.charge(left);
    left = server.allowance(now);
  }
  return left;
}

}  // namespace

// The periods of servers count from the origin of the grid.
void PreemptiveExecutor::open_servers(Nanoseconds origin) noexcept {
  for (JobThread& job : threads_) {
    if (!job.served) continue;
    job.served->server = ServerState(*spec(job).server, origin);
    job.served->charged = used_by(job.id);
  }
}

// By the thread of the task, without a job: when one may begin.
void PreemptiveExecutor::take_event(JobThread& me, Nanoseconds now) noexcept {
  Served& s = *me.served;
  if (!me.is_joined) return;
  if (!s.has_event) {
    me.next = kNever;
    if (task(me).events == 0) {
      s.is_active = false;
      return;
    }
    --task(me).events;
    if (!s.is_active) s.server.activate(now);
    s.is_active = s.has_event = true;
    s.taken = now;
  }
  pay(me);
  const bool may_begin = capacity_of(s.server, *spec(me).server, now) > Nanoseconds{};
  s.due = s.server.deadline();
  me.next = may_begin ? now : s.server.next_change(now);
}

// No event has come, and one that does may be taken at once: it stays readable meanwhile.
bool PreemptiveExecutor::listens(const JobThread& me) const noexcept {
  if (!me.served || !me.is_joined || me.is_held || is_paused_) return false;
  const Task& t = tasks_[me.task.index];
  return t.descriptor >= 0 && !me.served->has_event && t.events == 0;
}

// The task is not ON any more.
void PreemptiveExecutor::forget_event(JobThread& job) noexcept {
  Served& s = *job.served;
  if (s.has_event) ++task(job).profile.events_lost;
  s.is_active = s.has_event = false;
}

void PreemptiveExecutor::pay(JobThread& job) noexcept {
  Served& s = *job.served;
  const Nanoseconds all = used_by(job.id);
  if (all == kNever || all <= s.charged) return;
  if (!job.is_demoted) s.server.charge(all - s.charged);  // below all others no server counts
  s.charged = all;
}

// A job that waits at its label, runs or is halted: what the server has says where it belongs, and until when.
void PreemptiveExecutor::follow_server(JobThread& job, Nanoseconds now) noexcept {
  Served& s = *job.served;
  pay(job);
  const bool has_capacity = capacity_of(s.server, *spec(job).server, now) > Nanoseconds{};
  const bool has_begun = job.phase == JobPhase::kBegun;
  const bool moves = s.due != s.server.deadline();
  s.due = s.server.deadline();
  if (has_begun && !has_capacity && !s.is_halted) halt(job, now);
  else if (has_begun && has_capacity && s.is_halted) let_go_on(job, now);
  else if (moves && !s.is_halted) {
    (void)apply(labels_.rekey(job.task, urgency_of(job, spec(job).budget)), nullptr);
    processor_goes_on(now);
  }
  job.check = next_look_at_server(job, now);
}

void PreemptiveExecutor::halt(JobThread& job, Nanoseconds now) noexcept {
  Served& s = *job.served;
  s.is_halted = true;
  ++task(job).profile.exhausted;
  (void)apply(labels_.remove(job.task), nullptr);
  processor_goes_on(now);
  s.halt.ask();
}

void PreemptiveExecutor::let_go_on(JobThread& job, Nanoseconds now) noexcept {
  Served& s = *job.served;
  s.is_halted = false;
  LabelledJob again;
  again.task = job.task;
  again.urgency = urgency_of(job, spec(job).budget);
  (void)apply(labels_.insert(again), nullptr);
  processor_goes_on(now);
  s.halt.lift();
}

// The job is over. It may have come to its end when it was about to be halted.
void PreemptiveExecutor::end_served(JobThread& me) noexcept {
  Served& s = *me.served;
  s.has_event = false;
  if (s.is_halted) s.halt.lift();
  s.is_halted = false;
  pay(me);
}

// When a job that has the processor, or gets it now, will have used up what its server has.
Nanoseconds PreemptiveExecutor::end_of_capacity(JobThread& job, Nanoseconds now) noexcept {
  if (!job.served || job.is_demoted) return kNever;
  pay(job);
  return now + std::max(job.served->server.allowance(now), kSoonest);
}

Nanoseconds PreemptiveExecutor::next_look_at_server(JobThread& job, Nanoseconds now) noexcept {
  const Nanoseconds change = job.served->server.next_change(now);
  if (&job != on_processor_) return change;
  const Nanoseconds end = job.phase == JobPhase::kBegun ? end_of_budget(job, now) : kNever;
  return std::min({change, end, end_of_capacity(job, now)});
}

}  // namespace chimera
