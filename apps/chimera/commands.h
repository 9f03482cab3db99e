// SPDX-License-Identifier: Apache-2.0
// Every command of `chimera`: those on files, each a row with the function that carries it out, and those on a running
// subsystem (chimera/cli/live/commands.h).
#pragma once

#include <vector>

#include "chimera/cli/command/command.h"
#include "chimera/catalogue/workplace.h"

/// A command that needs no running subsystem. Plain value.
struct FileCommand {
  chimera::cli::Command words;
  /// Returns the exit code; nullptr: the command is nothing without one of its own commands.
  int (*carry_out)(const chimera::cli::Call& call, const chimera::Workplace& workplace) = nullptr;
};

/// The rows of one file each. Context of all: setup.
FileCommand check_row();
FileCommand schedule_row();
FileCommand bake_row();
FileCommand list_row();
FileCommand describe_row();
FileCommand test_row();
FileCommand new_row();
FileCommand new_component_row();
FileCommand new_application_row();
FileCommand new_firmware_row();
FileCommand run_row();
FileCommand idle_row();
FileCommand attend_row();
FileCommand sweep_row();
FileCommand web_row();
FileCommand shell_row();
FileCommand pages_row();
FileCommand version_row();

/// All rows in the order of `chimera --help`.
chimera::cli::Table all_commands();
/// Carries out a call of any of them. Returns the exit code; may block.
int carry_out(const chimera::cli::Call& call, const chimera::Workplace& workplace);
