// SPDX-License-Identifier: Apache-2.0
// A preemptive processor (preemptive.h) as one of several in virtual time.
#pragma once

#include "chimera/runtime/virtual/preemptive.h"
#include "chimera/runtime/virtual/stepped_processor.h"

namespace chimera {

/// Context of everything not marked: cycle; no allocation.
class SteppedPreemptive final : public SteppedProcessor {
 public:
  /// All arguments outlive this. Context: setup.
  SteppedPreemptive(Releases& releases, std::span<const TaskSpec> tasks, ModelledClock& clock,
                    const PreemptiveOptions& options)
      : SteppedProcessor(releases, clock), processor_(releases, tasks, clock, options) {}

  bool is_idle() const noexcept override { return processor_.is_idle(); }
  /// A job under way is cut: it neither completes nor counts.
  Nanoseconds finish(Nanoseconds now) noexcept override {
    processor_.record_slice(now);
    return now;
  }
  void cut(Nanoseconds now) noexcept override { processor_.record_slice(now); }

 private:
  bool is_busy() const noexcept override { return false; }
  void end_due(Nanoseconds now) noexcept override { processor_.end_due(now); }
  Nanoseconds edge(Nanoseconds now) noexcept override {
    processor_.run_edge(now);
    return now;
  }
  bool begin_job(Nanoseconds now) noexcept override {
    processor_.follow_servers(now);
    return processor_.dispatch_by_step(now);
  }
  Nanoseconds next_own(Nanoseconds now) noexcept override { return processor_.next_event(now); }

  Preemptive processor_;
};

}  // namespace chimera
