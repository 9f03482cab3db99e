// SPDX-License-Identifier: Apache-2.0
// NAME.cases.yaml: what an application must do in virtual time, written down by its user. docs/formats/cases.md.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/cli/batch/measured_run.h"
#include "chimera/description/report.h"

namespace chimera::cli {

inline constexpr std::array<std::string_view, 2> kCaseFileKeys = {"description", "cases"};
inline constexpr std::array<std::string_view, 9> kCaseKeys = {"for",  "set",        "at",      "expect", "strict",
                                                              "seed", "preemptive", "quantum", "every"};
inline constexpr std::string_view kCaseFileEnding = ".cases.yaml";

struct Case {
  std::string name;
  MeasuredRequest request;  ///< of the description that the file names
  bool strict = false;      ///< whatever a strict judge minds is a failure
};

struct CaseFile {
  std::string file;         ///< as its user named it
  std::string description;  ///< path of the description
  std::vector<Case> cases;
};

/// Reads `text`, naming it `file`; faults are added to `report`, which then has the last word. Context: setup.
CaseFile read_case_text(std::string_view text, const std::string& file, Report& report);
/// Reads the file at `path`. Context: setup; may block.
CaseFile read_case_file(const std::string& path, Report& report);

}  // namespace chimera::cli
