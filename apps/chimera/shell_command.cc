// SPDX-License-Identifier: Apache-2.0
// `chimera shell`, the hidden command `pages` that the build calls, and `--version`, which is read as a command.
#include <cstdio>

#include "apps/chimera/commands.h"
#include "apps/chimera/option_values.h"
#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/cli/command/page.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/cli/live/commands.h"
#include "chimera/cli/live/interactive.h"

using namespace chimera;  // NOLINT: a part of a main()
using cli::Call;
using cli::WordKind;

namespace {

int shell_of(const Call& call, const Workplace& workplace) {
  return cli::interactive({call.value("--subsystem"), workplace.unit_files}, call.operand(0), call.has("--keep-going"));
}

constexpr std::size_t kMostBytesOfPage = 1 << 20;

int pages(const Call& call, const Workplace&) {
  const auto text = read_ordinary(call.operand(0), kMostBytesOfPage);
  if (!text) return print(cli::file_refusal(text.error(), false));
  const auto made = cli::page(*text, all_commands());
  if (!made) return print(cli::file_refusal(made.error(), false));
  std::fputs(made->c_str(), stdout);
  return cli::kOk;
}

}  // namespace

FileCommand shell_row() {
  return {.words = {.name = "shell",
                    .help = "Type these commands one after the other, or take them from a file",
                    .operands = "[FILE]",
                    .most = 1,
                    .operand_kind = WordKind::kFile,
                    .operand_help = "a script: one command a line, # begins a comment; - is standard input",
                    .options = {{.name = "--keep-going",
                                 .help = "a script: go on after a refusal",
                                 .manual = "A script: go on after a refusal. Without it the first one ends the script, "
                                           "and its line is named.",
                                 .letter = "-k"}},
                    .json = nullptr,
                    .which = cli::kWhichOne,
                    .example = "chimera shell --subsystem puma_pid",
                    .manual = "Takes the commands above one after the other: typed, with history and completion of "
                              "commands, tasks, variables and configurations, or from a script, one command a line. "
                              "There `help` lists the commands and `quit` leaves; # begins a comment.",
                    .outlives_reader = true},
          .carry_out = shell_of};
}

FileCommand pages_row() {
  return {.words = {.name = "pages",
                    .help = "A page of the manual or the completion, filled in",
                    .operands = "FILE",
                    .least = 1,
                    .most = 1,
                    .operand_kind = WordKind::kFile,
                    .operand_help = "chimera/cli/command/page.h",
                    .json = nullptr,
                    .is_hidden = true},
          .carry_out = pages};
}

FileCommand version_row() {
  return {.words = {.name = "--version", .help = "Print the version", .json = "", .is_hidden = true},
          .carry_out = [](const Call&, const Workplace&) { return print({CHIMERA_VERSION "\n", "", cli::kOk}); }};
}
