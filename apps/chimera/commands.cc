// SPDX-License-Identifier: Apache-2.0
// Joins the tables of commands, and finds the function of a row.
#include "apps/chimera/commands.h"

#include <cstdio>

#include "chimera/cli/live/commands.h"
#include "chimera/cli/live/session.h"

using namespace chimera;  // NOLINT: a part of a main()

namespace {

const std::vector<FileCommand>& file_commands() {
  static const std::vector<FileCommand> kRows = {
      check_row(),    schedule_row(), bake_row(), run_row(), idle_row(), attend_row(), sweep_row(), web_row(),
      list_row(),     describe_row(), test_row(), new_row(), new_component_row(), new_application_row(),
      new_firmware_row(), pages_row(), version_row(), shell_row()};
  return kRows;
}

}  // namespace

cli::Table all_commands() {
  static const std::vector<const cli::Command*> kTable = [] {
    std::vector<const cli::Command*> table;
    for (const FileCommand& row : file_commands()) table.push_back(&row.words);
    for (const cli::RunningCommand& row : cli::running_commands())
      table.insert(table.end() - 1, &row.words);  // before the shell, which carries them out
    return table;
  }();
  return kTable;
}

int carry_out(const cli::Call& call, const Workplace& workplace) {
  for (const FileCommand& row : file_commands())
    if (&row.words == call.command) return row.carry_out(call, workplace);
  return cli::carry_out({call.value("--subsystem"), workplace.unit_files}, call, stdout, stderr);
}
