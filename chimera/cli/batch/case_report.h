// SPDX-License-Identifier: Apache-2.0
// Reports the results of the cases of a folder: for people, for programs, and for build machines.
#pragma once

#include <string>
#include <vector>

#include "chimera/cli/batch/case_file.h"
#include "chimera/cli/batch/measured_run.h"

namespace chimera::cli {

struct CaseOutcome {
  std::string name;
  MeasuredRun run;
  bool strict = false;
  Nanoseconds wall;

  /// Reasons why the case fails, a line each; empty: it passes.
  std::vector<std::string> complaints() const;
};

struct CaseFileOutcome {
  std::string file, description;
  std::vector<CaseOutcome> cases;
};

struct CaseReport {
  std::vector<CaseFileOutcome> files;

  std::size_t passed() const;
  std::size_t failed() const;
};

/// All of them. Context: setup.
std::string text(const CaseReport& report);
std::string json(const CaseReport& report);
/// JUnit XML as Jenkins and GitLab read it: a test suite for each file, a test case for each case; <failure> where an
/// expectation does not hold, <error> where the run did not come to its end.
std::string junit(const CaseReport& report);

}  // namespace chimera::cli
