// SPDX-License-Identifier: Apache-2.0
// One run in virtual time of which figures are taken, for commands that make many: `sweep` and `test`. It is carried
// out in a child process, so its outcome travels as a text.
#pragma once

#include <string>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/cli/run/measure.h"
#include "chimera/cli/run/run.h"
#include "chimera/cli/run/run_report.h"

namespace chimera::cli {

struct MeasuredRequest {
  RunRequest run;  ///< in virtual time, with a duration; `expect`, `watch` and `svg` are ignored
  std::vector<std::string> measures;  ///< measure.h
  std::vector<std::string> expect;    ///< measure.h
  Nanoseconds every;                  ///< distance of samples; 0: the shortest period
  std::string folder;                 ///< goes there before components are made, for good; "": stays
};

struct MeasuredRun {
  std::string failure;                   ///< why it did not come to its end; then the rest says nothing
  std::vector<Measure::Number> numbers;  ///< of the measures, in their order
  std::vector<RunReport::Judged> expectations;
  std::vector<std::string> remarks;  ///< what a strict judge minds: misses, faults, the flag, refusals
  Nanoseconds ran;
};

/// Runs it in this process. Context: setup; blocks.
MeasuredRun measured_run(const MeasuredRequest& request, const Library& library);
/// Whether it could begin: the description, the values, every word. Error::where is a place of the description.
/// Context: setup.
Result<void> judge_measured(const MeasuredRequest& request, const Library& library);

/// A run as text, and a run from such a text; any other text gives a run with a failure. Context: setup.
std::string encode(const MeasuredRun& run);
MeasuredRun decode_measured(const std::string& text);

}  // namespace chimera::cli
