// SPDX-License-Identifier: Apache-2.0
// One `chimera run` from its start to its exit code: watches, judges and reports, wherever the tasks are.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "chimera/cli/run/expectation.h"
#include "chimera/cli/run/run.h"
#include "chimera/cli/run/run_report.h"

namespace chimera::cli {

/// The present value of a state variable. Plain value.
struct Reading {
  Seen seen;
  std::string unit;
  std::string json;  ///< the value: docs/formats/control.md
};

/// The tasks that a session watches: in this process, or in processes of their own. Context: setup; may block.
class RunTarget {
 public:
  virtual ~RunTarget() = default;
  /// Has the tasks ON, or waits until they are, and prints how they run.
  virtual Result<void> start() = 0;
  /// Prints why the start failed, and ends the tasks that were made. Returns the exit code.
  virtual int refuse(const Error& error) = 0;
  /// Lets the run come to `until` (since its start) or to its end; nullopt: it goes on.
  virtual std::optional<RunEnd> advance(Nanoseconds until) = 0;
  /// Since the start.
  virtual Nanoseconds now() const = 0;
  /// Lines that were due before this instant (since the start) were printed by an earlier run client.
  virtual Nanoseconds printed_until() const { return {}; }
  /// Whether the values at an end of this kind are shown although no line is due.
  virtual bool shows_values_at(RunEnd end) const = 0;
  /// Puts the present values of the watched variables into a picture; false: there is none, a line is printed.
  virtual bool draws(Nanoseconds at) = 0;
  /// In the order of `names`.
  virtual std::vector<Reading> read(const std::vector<std::string>& names) = 0;
  /// Ends the tasks and fills in their results: everything of the report but the values of variables.
  virtual void finish(RunReport& report) = 0;
  /// The report is printed: false when output was lost or a picture cannot be written, which was said then.
  virtual bool is_output_complete(const RunReport& report) = 0;
};

/// Context: setup; blocks for the duration.
class RunSession {
 public:
  RunSession(const RunRequest& request, std::vector<Expectation> expectations, RunTarget& target, std::FILE* out,
             std::FILE* err)
      : request_(request),
        every_(request.every.count > 0 ? request.every : seconds(1)),
        expectations_(std::move(expectations)),
        target_(target),
        out_(out),
        err_(err) {}

  /// Starts, runs and reports; returns the exit code.
  int run();

 private:
  RunEnd watch();
  void show_values(Nanoseconds at);
  int report(RunEnd end);

  const RunRequest& request_;
  const Nanoseconds every_;
  std::vector<Expectation> expectations_;
  RunTarget& target_;
  std::FILE* out_;
  std::FILE* err_;
};

}  // namespace chimera::cli
