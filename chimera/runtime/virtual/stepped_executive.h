// SPDX-License-Identifier: Apache-2.0
// The non-preemptive loop of one processor of several in virtual time. A job that run_cycles (cycle_loop.h) runs in one
// go has two parts here, its beginning and its end, so that other processors act in between.
#pragma once

#include <optional>

#include "chimera/runtime/virtual/stepped_processor.h"

namespace chimera {

/// Context of everything not marked: cycle; no allocation.
class SteppedExecutive final : public SteppedProcessor {
 public:
  /// All arguments outlive this. Context: setup.
  SteppedExecutive(Releases& releases, ModelledClock& clock, std::optional<JobTimes> times) noexcept
      : SteppedProcessor(releases, clock), times_(times) {}

  bool is_idle() const noexcept override { return !has_job_ && releases_.queue().is_empty(); }
  Nanoseconds finish(Nanoseconds now) noexcept override;
  void cut(Nanoseconds now) noexcept override;

 private:
  bool is_busy() const noexcept override { return has_job_; }
  void end_due(Nanoseconds now) noexcept override;
  Nanoseconds edge(Nanoseconds now) noexcept override;
  bool begin_job(Nanoseconds now) noexcept override;
  Nanoseconds next_own(Nanoseconds now) noexcept override;
  void stand_at(Nanoseconds now) noexcept;

  std::optional<JobTimes> times_;
  bool has_job_ = false;  // the members below are of a job that has begun and not ended
  Job job_;
  CycleTime time_;
  BodyEnd body_;
  Nanoseconds start_, end_;
};

}  // namespace chimera
