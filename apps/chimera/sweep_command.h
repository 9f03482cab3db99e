// SPDX-License-Identifier: Apache-2.0
// `chimera sweep`: the words of the command line, and who carries them out.
#pragma once

#include <string>

#include "apps/chimera/run_command.h"
#include "chimera/desk/sweep.h"

/// Everything the command line can say about a sweep.
struct SweepWords {
  chimera::desk::SweepRequest sweep;
  SetWords set;
  std::string duration, every, quantum, seed, limit;
};

void add_sweep(CLI::App& app, SweepWords& words);
/// Answers the exit code.
int carry_out_sweep(SweepWords& words, const chimera::desk::Workplace& workplace);
