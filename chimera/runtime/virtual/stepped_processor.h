// SPDX-License-Identifier: Apache-2.0
// One processor of several in virtual time. The caller advances all of them together (virtual_rtpus.h). At each instant
// at which something may happen it calls: end_jobs, take_edge if one is due, release_jobs, dispatch.
#pragma once

#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera {

/// Context of everything not marked: cycle; no allocation.
class SteppedProcessor {
 public:
  virtual ~SteppedProcessor() = default;
  /// Jobs that are over at `now` publish, and the work they left is settled. Not while methods hold the processor.
  void end_jobs(Nanoseconds now) noexcept {
    if (!is_held(now) && !resumes_) end_due(now);
  }
  /// A cycle boundary is due and allowed: no job that cannot be preempted and no method has the processor.
  bool edge_is_due(Nanoseconds now) const noexcept {
    return !is_busy() && !is_held(now) && !resumes_ && releases_.edge_is_due(now);
  }
  /// Requires: edge_is_due(). The time that the methods spend holds the processor.
  void take_edge(Nanoseconds now) noexcept {
    held_until_ = edge(now);
    has_looked_ = true;
    resumes_ = held_until_ > now;
  }
  /// Requires: end_jobs() and, where it is due, take_edge() of this instant.
  void release_jobs(Nanoseconds now) noexcept {
    if (is_busy() || is_held(now) || !(has_looked_ || releases_.must_look(now))) return;
    has_looked_ = resumes_ = false;
    releases_.release_due(now);
    releases_.rest(kNever);
  }
  /// Begins the most urgent job. True if the instant is not over: a job needs no time, or was not to be started.
  bool dispatch(Nanoseconds now) noexcept { return !is_busy() && !is_held(now) && begin_job(now); }
  /// The next instant at which one of these has something to do, if nothing comes from elsewhere.
  Nanoseconds next_event(Nanoseconds now) noexcept { return is_held(now) ? held_until_ : next_own(now); }

  /// A method, or a job that cannot be preempted, has the processor.
  bool is_occupied(Nanoseconds now) const noexcept { return is_busy() || is_held(now); }
  /// No job is under way or waits.
  virtual bool is_idle() const noexcept = 0;
  /// The run ends at `now`: a job that cannot be preempted is finished. Returns the instant at which all is over.
  virtual Nanoseconds finish(Nanoseconds now) noexcept = 0;
  /// The processor is dead: records how long the present job has run.
  virtual void cut(Nanoseconds now) noexcept = 0;

 protected:
  SteppedProcessor(Releases& releases, ModelledClock& clock) noexcept : releases_(releases), clock_(clock) {}
  /// A job that cannot be preempted is under way.
  virtual bool is_busy() const noexcept = 0;
  virtual void end_due(Nanoseconds now) noexcept = 0;
  /// Runs the cycle boundary. Returns the instant at which its methods are over.
  virtual Nanoseconds edge(Nanoseconds now) noexcept = 0;
  virtual bool begin_job(Nanoseconds now) noexcept = 0;
  virtual Nanoseconds next_own(Nanoseconds now) noexcept = 0;
  void hold_until(Nanoseconds instant) noexcept { held_until_ = instant; }

  Releases& releases_;
  ModelledClock& clock_;

 private:
  bool is_held(Nanoseconds now) const noexcept { return held_until_ > now; }

  Nanoseconds held_until_;   // by methods
  bool has_looked_ = false;  // a cycle boundary has run: releases come next
  bool resumes_ = false;     // they come after the time that the methods of the cycle boundary spent
};

}  // namespace chimera
