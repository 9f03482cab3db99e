// SPDX-License-Identifier: Apache-2.0
// Messages about a command line that cannot be read: the nearest option, a missing quote, an example.
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

/// Prints the fault and what to write instead; `argv` is the command line that `app` refused with `fault`. The exit
/// code: 0 after --help and --version. Context: setup.
int report_wrong_usage(const CLI::App& app, const CLI::ParseError& fault, int argc, char** argv);
/// Reports, as report_wrong_usage() does, an option that stood before `command`, which does not have it.
int report_no_option(const std::string& option, const CLI::App& command);
