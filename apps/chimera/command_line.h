// SPDX-License-Identifier: Apache-2.0
// The command line of `chimera`, made from the table of commands.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "chimera/cli/command/command.h"

/// Context: setup.
class CommandLine {
 public:
  /// `documents` is where docs/ and examples/ are: the help ends with it.
  CommandLine(chimera::cli::Table table, const std::string& documents);
  ~CommandLine();
  /// Reads what was typed. Nothing when there is nothing to carry out: the help or a fault was printed, and
  /// exit_code() is that of the program.
  std::optional<chimera::cli::Call> read(int argc, char** argv);
  int exit_code() const noexcept { return exit_code_; }

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  int exit_code_ = 0;
};
