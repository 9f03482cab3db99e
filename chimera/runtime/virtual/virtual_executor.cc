// SPDX-License-Identifier: Apache-2.0
// Runs the cycle loop on a modelled clock.
#include "chimera/runtime/virtual/virtual_executor.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/runtime/cycle/cycle_loop.h"
#include "chimera/runtime/hosted/refusal_text.h"

namespace chimera {
namespace {

// Virtual time without preemption: a job ends when its modelled time is used up; nothing else makes time pass.
struct ModelledTime {
  Releases& releases;
  ModelledClock& clock;
  const JobTimes* times;  // null: none
  Nanoseconds origin;
  Nanoseconds& now_;

  Nanoseconds now() noexcept {
    set(now_ + clock.spent());  // by methods at the cycle boundary
    return now_;
  }
  void wait_until(Nanoseconds instant) noexcept { set(std::max(instant, now_)); }  // methods may have lasted longer
  Nanoseconds end_of(const Job& job, BodyEnd body, Nanoseconds start) noexcept {
    const bool had_event = body.answer != Answer::kNoEvent;
    Task& task = releases.task(job.task);
    if (task.background != nullptr && had_event) run_background(task, Method::kCycle, start);
    set(start + modelled_time(*task.spec, job.task, job.release - origin, clock.spent(), had_event, times));
    return now_;
  }
  Nanoseconds after(Nanoseconds end) noexcept {
    set(end + clock.spent());  // by the method error
    return now_;
  }

 private:
  void set(Nanoseconds now) noexcept {
    now_ = now;
    clock.set(now);
  }
};

RunOptions with_preemption(RunOptions options, bool preemptive) noexcept {
  options.preemptive = preemptive;
  return options;
}

}  // namespace

VirtualExecutor::VirtualExecutor(TaskSet& set, const RunOptions& options, const VirtualOptions& how)
    : set_(set), how_(how), releases_(set, clock_, with_preemption(options, how.preemptive)),
      preemptive_(releases_, set.spec().tasks, clock_, {how.times, how.quantum}) {
  if (how.times && how.times->are_zero) clock_.stand_still();
  CHIMERA_ASSERT(how.quantum > Nanoseconds{});
  for (const TaskSpec& task : set.spec().tasks) CHIMERA_ASSERT(how.preemptive || !task.server);
}

Result<void> VirtualExecutor::start() {
  clock_.set(now_);
  const auto wait = [this](Nanoseconds at) {
    clock_.set(std::max(at, clock_.now()));
    return clock_.now();
  };
  Result<void> started = start_result(set_, set_.life().start(now_, wait));
  now_ = clock_.now();
  if (started) releases_.begin(now_);
  return started;
}

RunEnd VirtualExecutor::run(Nanoseconds duration) noexcept {
  const Nanoseconds until = duration == kNever ? kNever : origin() + duration;
  clock_.set(now_);
  if (how_.preemptive) return preemptive_.run(now_, until);
  ModelledTime time{releases_, clock_, how_.times ? &*how_.times : nullptr, origin(), now_};
  return run_cycles(releases_, time, until);
}

}  // namespace chimera
