// SPDX-License-Identifier: Apache-2.0
// `chimera run` and its hidden half `chimera attend`: the words of the command line, and who carries them out.
#pragma once

#include <string>
#include <vector>

#include "chimera/desk/attend.h"
#include "chimera/desk/workplace.h"

namespace CLI {
class App;
}  // namespace CLI

/// Everything the command line can say about a run.
struct RunWords {
  chimera::desk::RunRequest run;
  std::string duration, every, quantum, seed;
  std::string trace, timeline;
  std::string isolation = "process";
  std::string observe_group, operate_group, configure_group;
  std::string idle_name = "idle";
  // of `attend` only
  std::string socket;
  int parent = 0;
  std::vector<double> bounds;
};

/// An option that takes the name of a file; an empty one is a wrong call, not "no file".
void add_file_option(CLI::App& app, const char* name, std::string& file, const char* help);
/// The subcommands `run`, `idle` and `attend`.
void add_run(CLI::App& app, RunWords& words);
/// Carries out `run`: in this process, or as the keeper of others. Answers the exit code.
int carry_out_run(RunWords& words, const chimera::desk::Workplace& workplace);
/// Carries out `attend`.
int carry_out_attend(RunWords& words);
