// SPDX-License-Identifier: Apache-2.0
// The measures of --expect in real time: of every value that the tasks publish, over a connection of its own
// (docs/formats/control.md, `tap`). Values of operator variables come every 20 ms.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "chimera/cli/run/control_line.h"
#include "chimera/cli/run/measure.h"
#include "chimera/cli/run/run_report.h"

namespace chimera::cli {

/// Context: setup; blocks.
class MeasureLine {
 public:
  /// `measures` as Measure::with_bound() makes them.
  MeasureLine(const std::string& socket, std::vector<Measure> measures)
      : line_(socket), measures_(std::move(measures)) {}

  bool is_needed() const noexcept { return !measures_.empty(); }
  /// Subscribes, if it is needed. `started`: of the run, CLOCK_MONOTONIC.
  Result<void> begin(Nanoseconds started) {
    started_ = started;
    return is_needed() ? subscribe() : Result<void>();
  }
  /// Adds what comes until `instant`; returns with the first, or earlier when a signal came.
  void poll(Nanoseconds instant);
  /// Adds what was published until `end` and is under way, then judges. `is_whole`: the line was there from the start.
  void finish(Nanoseconds end, bool is_whole, RunReport& report);

 private:
  struct Known {
    std::string unit;
    bool is_scalar = true;
  };

  Result<void> subscribe();
  void add(const std::string& variable, const Json& value, Nanoseconds at);

  ControlLine line_;
  std::vector<Measure> measures_;
  Nanoseconds started_, end_ = kNever;
  std::map<std::string, Known> known_;
  std::map<std::string, std::string> refusals_;  // of measures of an element that is not there
  bool has_gap_ = false;
};

}  // namespace chimera::cli
