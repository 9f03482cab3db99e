// SPDX-License-Identifier: Apache-2.0
// `chimera run` and its hidden half `chimera attend`: the words of the command line, and who carries them out.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "chimera/desk/attend.h"
#include "chimera/desk/workplace.h"

namespace CLI {
class App;
}  // namespace CLI

/// `--set VAR VALUE`, as often as one likes.
using SetWords = std::vector<std::pair<std::string, std::string>>;

/// Everything the command line can say about a run.
struct RunWords {
  chimera::desk::RunRequest run;
  SetWords set;
  std::string duration, start_limit, every, quantum, seed;
  std::string trace, timeline;
  std::string isolation = "process";
  std::string observe_group, operate_group, configure_group;
  std::string idle_name = "idle";
  // of `attend` only
  std::string socket;
  int parent = 0;
  std::vector<double> bounds;
};

void add_set_option(CLI::App& app, SetWords& words);
std::vector<chimera::Setting> settings_of(const SetWords& words);
/// An option that takes the name of a file; an empty one is a wrong call, not "no file".
void add_file_option(CLI::App& app, const char* name, std::string& file, const char* help);
/// A duration above 0, when something was said; false when it is none, which was said then.
bool read_duration(const std::string& text, const char* option, chimera::Nanoseconds& to);
bool read_seed(const std::string& text, std::optional<std::uint64_t>& to);
/// The subcommands `run`, `idle` and `attend`.
void add_run(CLI::App& app, RunWords& words);
/// Carries out `run`: in this process, or as the keeper of others. Answers the exit code.
int carry_out_run(RunWords& words, const chimera::desk::Workplace& workplace);
/// Carries out `attend`.
int carry_out_attend(RunWords& words);
