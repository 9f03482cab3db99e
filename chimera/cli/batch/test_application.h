// SPDX-License-Identifier: Apache-2.0
// `chimera test DIR...`: every case of every NAME.cases.yaml in a folder, in virtual time, judged by what it says.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/catalogue/workplace.h"

namespace chimera::cli {

struct CasesRequest {
  std::vector<std::string> places;  ///< folders, searched with all below them, or files NAME.cases.yaml
  std::vector<std::string> only;    ///< names of cases; empty: all
  std::size_t jobs = 0;             ///< at a time; 0: as many as there are processors
  Nanoseconds limit = kNever;       ///< of the clock on the wall, for each case
  std::string junit;                ///< write the report of a build machine into this file; "": not
  bool json = false;
};

/// Whether the word is a place of cases: a folder, or a file of them. A bare word that is a component is not.
/// Context: setup; may block.
bool is_place_of_cases(const std::string& word, const Library& library);

/// Runs them side by side, each in the folder of its description; kOk when all pass. Refuses a place without a case,
/// and a file with a fault before anything runs. Call it with one thread. Context: setup; blocks.
int test_application(const CasesRequest& request, const Workplace& workplace, std::FILE* out, std::FILE* err);

}  // namespace chimera::cli
