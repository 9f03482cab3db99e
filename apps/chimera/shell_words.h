// SPDX-License-Identifier: Apache-2.0
// The words of the commands on a running subsystem: status on off ... scope shell.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
}

/// What the words said; filled in by the parser.
struct ShellWords;
std::shared_ptr<ShellWords> add_shell_commands(CLI::App& app);

/// The exit code of the command that was given; -1 when it was none of these.
int carry_out_shell_command(const CLI::App& app, const ShellWords& words, const std::vector<std::string>& unit_files);
