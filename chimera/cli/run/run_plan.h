// SPDX-License-Identifier: Apache-2.0
// Checks of `chimera run` before the start: the description is legal and can be run, and every word of the command line
// means something in it.
#pragma once

#include <cstdio>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/cli/run/expectation.h"
#include "chimera/cli/run/measure.h"
#include "chimera/cli/run/own_process.h"
#include "chimera/runtime/cycle/script.h"
#include "chimera/verify/configuration.h"

namespace chimera::cli {

struct RunRequest;

/// A run that may begin.
struct RunPlan {
  Library library;
  std::string description;  ///< the text of the file, as it was read
  Configuration configuration;      ///< with the settings of the request
  std::vector<ScriptAct> acts;
  std::vector<Configuration> set;   ///< one for each act `set`, which has its value there
  std::deque<TaskLists> lists;      ///< one for each act `switch` that names tasks
  std::vector<Expectation> expectations;
  std::vector<Measure> measures;    ///< expectations of the whole run
  std::vector<Bound> bounds;        ///< of RunRequest::expect
};

/// Prints the report and the verdict; nothing when the run is refused, which has been said then. `code`, where there is
/// one, is then kUsage for words of the command line that fit no description, else kRefused. Context: setup; may block.
std::optional<RunPlan> plan_run(const RunRequest& request, const Workplace& workplace, std::FILE* out, std::FILE* err,
                                int* code = nullptr);

/// plan_run() with a library that was read before.
std::optional<RunPlan> plan_run(const RunRequest& request, const Library& library, std::FILE* out, std::FILE* err,
                                int* code = nullptr);

/// Adds the acts of RunRequest::at to the plan of a legal description. Refuses, with the text of the act, what means
/// nothing in it or comes after the end of the run. Context: setup.
Result<void> judge_acts(const RunRequest& request, RunPlan& plan);

/// The distance of samples in virtual time: `every`, or if that is 0 the shortest period of the start set; longer if
/// there were more than a million. Context: setup.
Nanoseconds sample_distance(Nanoseconds every, Nanoseconds duration, const ApplicationSpec& spec);

/// Refuses a start set whose budgets take more of a CPU than may be promised when the kernel leaves `share` of it to
/// real-time threads: 0.02 less. Context: setup.
Result<void> admit_below(const Configuration& configuration, double share);

/// Prints a refusal as the request wants it, and answers `code`.
int refuse_run(const RunRequest& request, const Error& error, std::FILE* out, std::FILE* err, int code = 1);
/// Reports a run that did not come to its end, by the task whose method was under way, else by its file.
int report_broken_run(const RunRequest& request, const BrokenRun& broken, std::FILE* out, std::FILE* err);

}  // namespace chimera::cli
