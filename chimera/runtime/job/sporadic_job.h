// SPDX-License-Identifier: Apache-2.0
// The jobs of one task behind a server: which event the present job answers, how urgent it is, and whether the server
// has capacity for it. Bookkeeping only, shared by the preemptive executor and by virtual time: the executor keeps the
// ready list, measures what a job used and takes it off the processor.
//
//   no event --accept()--> event, server active --finish()--> no event, server active
//      ^                       |                                 |
//      |<------forget()--------+<------accept(): another one ----+
//      +<------------------------------accept(): none waits -----+
//
// The server is active from the first event on until accept() finds none. Events are answered one after the other.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/schedule/server_state.h"

namespace chimera {

/// Sporadic or deferrable, as the server is. Context: cycle; wait-free; no allocation. One thread at a time.
class SporadicJob {
 public:
  /// The server's decision about the job from now on.
  struct Grant {
    bool may_run = false;               ///< there is capacity
    bool has_another_deadline = false;  ///< than at the last grant: the job belongs elsewhere among the ready ones
  };

  /// A rest of capacity below `granularity` counts as used (but never more than a quarter of the capacity); zero: every
  /// nanosecond is granted.
  explicit SporadicJob(const ServerSpec& spec, Nanoseconds granularity = {}) noexcept;

  /// The server is full at `origin` and its periods count from there.
  void start(Nanoseconds origin) noexcept { server_ = ServerState(spec_, origin); }
  /// Pops one of the `waiting` events unless the present one is not answered yet. True when there is one to answer.
  bool accept(std::uint32_t& waiting, Nanoseconds now) noexcept;
  /// The event is answered.
  void finish() noexcept { has_event_ = false; }
  /// The task is not ON any more. True when an event was lost that had been accepted.
  bool forget() noexcept;

  bool has_event() const noexcept { return has_event_; }
  /// When the present event was accepted: the release of its job.
  Nanoseconds release() const noexcept { return release_; }
  /// Deadline of the server at the last grant: the urgency of the job.
  Nanoseconds deadline() const noexcept { return deadline_; }

  /// Brings the server up to `now`. Requires: accept() was true.
  Grant grant(Nanoseconds now) noexcept;
  /// Charges the server with the processor time `used` of the job.
  void charge(Nanoseconds used) noexcept { server_.charge(used); }
  /// How long the job may run from `now` on. Requires: grant(now), or nothing changed by itself since then.
  Nanoseconds allowance(Nanoseconds now) const noexcept { return server_.allowance(now); }
  /// When another grant may differ though nothing is charged; kNever: not by itself.
  Nanoseconds next_change(Nanoseconds now) const noexcept { return server_.next_change(now); }

 private:
  ServerSpec spec_;
  Nanoseconds smallest_;  // capacity that is granted
  ServerState server_;
  Nanoseconds release_, deadline_;
  bool is_active_ = false;  // an event waits or is answered
  bool has_event_ = false;
};

}  // namespace chimera
