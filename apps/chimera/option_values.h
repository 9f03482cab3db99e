// SPDX-License-Identifier: Apache-2.0
// The values of options that several commands share. Every function that reads one prints what is wrong with it and
// returns false then. Context of all: setup.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/cli/command/command.h"
#include "chimera/cli/command/command_result.h"
#include "chimera/verify/setting.h"

/// The option --set, which `check`, `schedule`, `run` and `sweep` have.
chimera::cli::Option set_option(const char* manual);
/// Its values.
std::vector<chimera::Setting> settings_of(const chimera::cli::Call& call);
/// A duration above 0, when the option was given.
bool read_duration(const chimera::cli::Call& call, const char* option, chimera::Nanoseconds& to);
/// A whole number that the command line has judged already, when the option was given.
template <class Number>
void read_number(const chimera::cli::Call& call, const char* option, Number& to) {
  if (call.has(option)) to = static_cast<Number>(std::stoull(call.value(option)));
}

/// On standard output and standard error.
int print(const chimera::cli::CommandResult& result);
/// The run that goes on in this process ends at SIGINT and SIGTERM, and reports.
void stop_run_at_signals();
