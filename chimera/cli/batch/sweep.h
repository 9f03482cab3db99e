// SPDX-License-Identifier: Apache-2.0
// `chimera sweep`: one description run in virtual time over lists of values, side by side, and one table of what came
// out.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "chimera/cli/batch/measured_run.h"
#include "chimera/catalogue/workplace.h"

namespace chimera::cli {

struct SweepRequest {
  MeasuredRequest each;           ///< of every run; its settings hold for all of them
  std::vector<std::string> over;  ///< value_list.h; the first varies slowest
  std::size_t jobs = 0;           ///< at a time; 0: as many as there are processors
  Nanoseconds limit = kNever;     ///< of the clock on the wall, for each run
  std::string csv, svg;           ///< write the table, draw the picture into these files; "": not
  bool json = false;
};

/// Prints the table; kOk when every run came to its end and met every expectation. The same bytes whatever the number
/// of jobs. Call it with one thread. Context: setup; blocks.
int sweep(const SweepRequest& request, const Workplace& workplace, std::FILE* out, std::FILE* err);

}  // namespace chimera::cli
