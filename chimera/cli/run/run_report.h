// SPDX-License-Identifier: Apache-2.0
// The report at the end of every run, in virtual or real time: docs/formats/run.md.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "chimera/analysis/task_profile.h"
#include "chimera/cli/run/expectation.h"
#include "chimera/cli/run/run_verdict.h"
#include "chimera/runtime/cycle/releases.h"

namespace chimera::cli {

/// Plain value.
struct RunReport {
  struct Watched {
    std::string name, unit;
    std::string value;  ///< JSON
  };
  struct Judged {
    std::string text, said;
    bool holds = false;
  };

  RunEnd end = RunEnd::kTime;
  std::string stopped_by;              ///< kTaskStopped: the task, where it is known; kStopped: why, if not by a person
  bool is_flag_up = false;             ///< the illegal-configuration flag at the end
  Nanoseconds ran;
  std::string subsystem;
  std::string executor;                ///< how it was run, for people
  std::string refused;                 ///< a line for each refused signal
  std::string switches;                ///< lines for each switch that was asked for
  std::string receipts;                ///< of these as JSON, with commas between them
  std::uint64_t receipts_left_out = 0; ///< of more switches than receipts are kept
  std::vector<TaskProfile> profiles;
  Nanoseconds origin;                  ///< of `ran`; faults are timed from it
  std::vector<Watched> variables;
  std::vector<Judged> expectations;
  RunVerdict verdict;

  void judge(const Expectation& expectation, const Seen& seen);
  /// kOk when it came to its end, every expectation holds and the verdict is no failure.
  int code() const;
};

/// Writes what `chimera schedule --profile` reads; false, with the reason on `err`, when that cannot be. No path:
/// nothing to do. Context: setup; may block.
bool save_profile(const RunReport& report, const std::string& path, std::FILE* err);

/// A note of a component, as a line of a run. Context: setup.
std::string note_line(std::string_view task, std::string_view note);

/// As text or as one JSON object. Context: setup.
void print(const RunReport& report, bool json, std::FILE* out);

}  // namespace chimera::cli
