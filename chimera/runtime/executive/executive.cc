// SPDX-License-Identifier: Apache-2.0
// Runs the cycle loop on a calibrated clock until a stop is requested.
#include "chimera/runtime/executive/executive.h"

#include "chimera/runtime/cycle/cycle_loop.h"

namespace chimera {
namespace {

// Real time: a job ends when the clock says so.
struct RealTime {
  Clock& clock;

  Nanoseconds now() noexcept { return clock.now(); }
  void wait_until(Nanoseconds instant) noexcept { clock.wait_until(instant); }
  Nanoseconds end_of(const Job&, BodyEnd, Nanoseconds) noexcept { return clock.now(); }
  Nanoseconds after(Nanoseconds end) noexcept { return end; }  // what publication took counts for the next job
};

}  // namespace

Executive::Executive(TaskSet& set, Clock& clock, JobClock& job_clock, const RunOptions& options)
    : set_(set), clock_(clock), releases_(set, job_clock, options) {}

SignalReport Executive::start() {
  const SignalReport started = set_.life().start(clock_.now(), [this](Nanoseconds at) {
    clock_.wait_until(at);
    return clock_.now();
  });
  if (started) releases_.begin(clock_.now());
  return started;
}

RunEnd Executive::run(Nanoseconds duration) noexcept {
  RealTime time{clock_};
  return run_cycles(releases_, time, duration == kNever ? kNever : origin() + duration);
}

}  // namespace chimera
